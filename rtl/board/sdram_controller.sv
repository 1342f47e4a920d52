// SPDX-License-Identifier: Apache-2.0
// Controller of a 256 Mbit SDR SDRAM, 4 banks x 8192 rows x 512 columns x 16 bits: reads whole lines of LineHalfwords, writes
// words of 32 bits, initialises and refreshes. Everything is in the SDRAM's clock domain; ClockKHz is its frequency, from
// which the cycles of the data sheet's times follow (those of the slowest grade that it is to serve, docs/photon_memory.md).
//
// An address counts halfwords: a line starts at a multiple of the power of two not under LineHalfwords; the two bits above
// choose the bank, so that neighbouring lines lie in different banks. Rows stay open. While a line is read, the row of the
// next one is opened, unless it is in the same bank; then lines follow one another without a gap.
//
// A line is read in bursts of 8, CAS latency 3; its halfwords come in order, one a cycle, ReadLatency cycles after their
// READ was decided, and lines in the order of their requests. Throughput: LineHalfwords cycles a line; one whose bank is
// busy with another row waits for PRECHARGE and ACTIVATE; a refresh takes about 12 cycles in 780 at 100 MHz.
//
// With RefreshesAhead an SDRAM of which nobody has wanted anything for 8 cycles is refreshed before it must be, up to so many
// times; while they last, lines wait for one in RowIntervals intervals, for a row may not stay open longer. Every row is
// still refreshed within 64 ms: they come as much oftener.
module sdram_controller #(
    parameter int unsigned ClockKHz = 100000,
    parameter int unsigned LineHalfwords = 64,
    parameter int unsigned RefreshesAhead = 0,  // 0 to 255
    parameter int unsigned RowIntervals = 11  // without a refresh, at most; 7.8 us each, and a row may be open for 120 us; 2 to 15
) (
    input  logic        clk_i,
    input  logic        rst_i,
    output logic        ready_o,        // initialised
    // requests
    input  logic        req_valid_i,
    output logic        req_ready_o,
    input  logic        req_write_i,    // a word, else a line
    input  logic [23:0] req_address_i,  // in halfwords, of a word even
    input  logic [31:0] req_data_i,
    // halfwords of lines, always taken
    output logic        rsp_valid_o,
    output logic [15:0] rsp_data_o,
    // the chip; every output comes from a register
    output logic        sdram_cke_o,
    output logic        sdram_cs_no,
    output logic        sdram_ras_no,
    output logic        sdram_cas_no,
    output logic        sdram_we_no,
    output logic [ 1:0] sdram_ba_o,
    output logic [12:0] sdram_a_o,
    output logic [ 1:0] sdram_dqm_o,
    input  logic [15:0] sdram_dq_i,
    output logic [15:0] sdram_dq_o,
    output logic        sdram_dq_oe_o
);
  // Cycles of a time in ns.
  function automatic int unsigned cycles(input int unsigned ns);
    cycles = (ns * ClockKHz + 999999) / 1000000;
  endfunction

  localparam int unsigned PowerUp = 200 * (ClockKHz / 1000) + 200;  // 200 us
  // One that is ahead is made again up to 8192 + RefreshesAhead intervals later.
  localparam int unsigned RefreshNs = RefreshesAhead == 0 ? 7800 : 64000000 / (8193 + RefreshesAhead);
  localparam int unsigned RefreshEvery = RefreshNs * (ClockKHz / 1000) / 1000;
  localparam int unsigned RowToColumn = cycles(21);
  localparam int unsigned Precharge = cycles(21);
  localparam int unsigned RowActive = cycles(44);
  localparam int unsigned RowToRow = cycles(15);
  localparam int unsigned WriteRecovery = cycles(15);
  localparam int unsigned RefreshTime = cycles(66);
  localparam int unsigned ModeTime = cycles(14) > 2 ? cycles(14) : 2;
  localparam int unsigned InitRefreshes = 8;
  localparam int unsigned CasLatency = 3;
  localparam int unsigned ReadLatency = CasLatency + 2;  // command register, CAS latency, data register
  localparam int unsigned Bursts = LineHalfwords / 8;
  localparam int unsigned BurstBits = $clog2(Bursts + 1);
  localparam int unsigned LineColumnBits = $clog2(LineHalfwords);
  // Timers count up; the top bit says that the time is over, without a comparison.
  localparam int unsigned TimerBits = 5;
  localparam logic [TimerBits-1:0] Over = 5'b10000;
  localparam int unsigned WaitBits = $clog2(PowerUp + 1);
  localparam int unsigned RefreshBits = $clog2(RefreshEvery);
  // Burst of 8, sequential, CAS latency 3, writes of single words.
  localparam logic [12:0] Mode = 13'b0001000110011;
  localparam logic [12:0] AllBanks = 13'h400;  // a PRECHARGE with A10

  if (LineHalfwords % 8 != 0 || LineHalfwords > 512) begin : gen_bad_line
    sdram_lines_must_be_whole_bursts_of_16_bytes_and_fit_in_a_row bad_line ();
  end
  if (RefreshesAhead > 255 || RowIntervals < 2 || RowIntervals > 15) begin : gen_bad_refreshes
    sdram_refreshes_ahead_are_0_to_255_and_row_intervals_2_to_15 bad_refreshes ();
  end
  if (RefreshTime > 15 || RowActive + 2 > 15) begin : gen_bad_clock
    sdram_clock_is_too_fast_for_the_timers bad_clock ();
  end

  // {cs, ras, cas, we}, all active low
  localparam logic [3:0] Nop = 4'b0111, Active = 4'b0011, Read = 4'b0101, Write = 4'b0100, PrechargeRow = 4'b0010,
      AutoRefresh = 4'b0001, LoadMode = 4'b0000;

  // ---- the request that is next: from its acceptance to its READ or second WRITE ----
  logic next_valid_q, next_write_q, second_q;
  logic [1:0] next_bank_q;
  logic [8:0] next_column_q;
  logic [12:0] next_row_q;
  logic [31:0] next_data_q;
  logic next_done;

  assign req_ready_o = !next_valid_q && ready_o;
  always_ff @(posedge clk_i) begin
    if (req_ready_o) begin
      next_write_q <= req_write_i;
      next_bank_q <= 2'(req_address_i >> LineColumnBits);
      next_column_q <= 9'((req_address_i >> (LineColumnBits + 2) << LineColumnBits) |
          (req_address_i & 24'((1 << LineColumnBits) - 1)));
      next_row_q <= req_address_i[23:11];
      next_data_q <= req_data_i;
      next_valid_q <= req_valid_i;
    end else if (next_done) begin
      next_valid_q <= 1'b0;
    end
    if (rst_i) next_valid_q <= 1'b0;
  end

  // ---- banks: open rows, and cycles until a column, a PRECHARGE, an ACTIVATE may follow ----
  logic [3:0] open_q, may_column, may_precharge, may_activate;
  logic [4*13-1:0] row_q;
  logic [4*TimerBits-1:0] column_wait_q, precharge_wait_q, activate_wait_q;
  logic [TimerBits-1:0] row_wait_q;  // until an ACTIVATE of any bank

  for (genvar bank = 0; bank < 4; bank++) begin : gen_bank
    assign may_column[bank] = column_wait_q[TimerBits*bank+TimerBits-1];
    assign may_precharge[bank] = precharge_wait_q[TimerBits*bank+TimerBits-1];
    assign may_activate[bank] = activate_wait_q[TimerBits*bank+TimerBits-1];
  end

  // ---- the line being read ----
  logic [BurstBits-1:0] bursts_q;  // to come after the running one
  logic [2:0] gap_q;  // cycles until the next READ
  logic [1:0] burst_bank_q;
  logic [8:0] burst_column_q;
  logic bursting;
  assign bursting = bursts_q != '0 || gap_q != '0;
  // A WRITE waits until the chip has let go of the data pins.
  logic [ReadLatency:0] reading_q;
  logic reading;

  // ---- initialisation and refresh ----
  logic run_q, waiting, refresh_due_q, mode_set_q, precharged_q;
  logic [WaitBits-1:0] wait_q;
  logic [RefreshBits-1:0] refresh_q;
  logic [3:0] init_refreshes_q;
  assign ready_o = run_q;
  assign waiting = wait_q != '0;

  // A refresh is owed, or the SDRAM may have one before it is.
  logic refresh_owed, refresh_early;

  // ---- one command a cycle ----
  logic row_open, read_more, read_first, write_now, activate, precharge, precharge_all, refresh, load_mode;
  assign row_open = open_q[next_bank_q] && row_q[13*next_bank_q+:13] == next_row_q;
  assign read_more = bursts_q != '0 && gap_q == '0;
  assign read_first = run_q && !bursting && next_valid_q && !next_write_q && row_open && may_column[next_bank_q] &&
      !refresh_due_q;
  assign write_now = run_q && !bursting && reading_q == '0 && next_valid_q && next_write_q && row_open &&
      may_column[next_bank_q] && (!refresh_due_q || second_q);
  assign activate = run_q && !read_more && next_valid_q && !open_q[next_bank_q] && may_activate[next_bank_q] &&
      row_wait_q[TimerBits-1] && !refresh_due_q;
  assign precharge = run_q && !read_more && next_valid_q && open_q[next_bank_q] && !row_open &&
      may_precharge[next_bank_q] && !(bursting && burst_bank_q == next_bank_q) && !refresh_due_q;
  assign precharge_all = !waiting && !precharged_q && (run_q ? refresh_due_q && !bursting && !second_q && may_precharge == '1 : 1'b1);
  assign refresh = !waiting && precharged_q && may_activate == '1 && (run_q ? refresh_due_q : init_refreshes_q != '0);
  assign load_mode = !waiting && precharged_q && may_activate == '1 && !run_q && init_refreshes_q == '0 && !mode_set_q;
  assign next_done = read_first || (write_now && second_q);
  assign reading = read_first || read_more || gap_q != '0;

  logic [3:0] command_q;
  assign {sdram_cs_no, sdram_ras_no, sdram_cas_no, sdram_we_no} = command_q;

  // The chip may see no command before its pause is over, not even before the first edge of reset.
  initial begin
    command_q = Nop;
    sdram_dq_oe_o = 1'b0;
  end

  always_ff @(posedge clk_i) begin
    command_q <= Nop;
    sdram_ba_o <= read_more ? burst_bank_q : next_bank_q;
    // What the command will be is decided late; what its address must be then follows from less.
    if (read_more) sdram_a_o <= {4'b0, burst_column_q};
    else if (!run_q) sdram_a_o <= precharged_q ? Mode : AllBanks;
    else if (refresh_due_q && !second_q) sdram_a_o <= AllBanks;
    else if (open_q[next_bank_q]) sdram_a_o <= {4'b0, next_column_q[8:1], next_column_q[0] || second_q};
    else sdram_a_o <= next_row_q;
    sdram_dq_o <= second_q ? next_data_q[31:16] : next_data_q[15:0];
    sdram_dq_oe_o <= write_now;
    if (read_more) begin
      command_q <= Read;
    end else if (read_first) begin
      command_q <= Read;
    end else if (write_now) begin
      command_q <= Write;
    end else if (activate) begin
      command_q <= Active;
    end else if (precharge) begin
      command_q <= PrechargeRow;
    end else if (precharge_all) begin
      command_q <= PrechargeRow;
    end else if (refresh) begin
      command_q <= AutoRefresh;
    end else if (load_mode) begin
      command_q <= LoadMode;
      sdram_ba_o <= '0;
    end
    sdram_cke_o <= 1'b1;
    sdram_dqm_o <= run_q ? 2'b00 : 2'b11;
    if (rst_i) begin
      command_q <= Nop;
      sdram_dq_oe_o <= 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    // bursts
    gap_q <= read_first || read_more ? 3'd7 : gap_q == '0 ? '0 : gap_q - 1'b1;
    if (read_first) begin
      bursts_q <= BurstBits'(Bursts - 1);
      burst_bank_q <= next_bank_q;
      burst_column_q <= next_column_q + 9'd8;
    end else if (read_more) begin
      bursts_q <= bursts_q - 1'b1;
      burst_column_q <= burst_column_q + 9'd8;
    end
    if (write_now) second_q <= !second_q;
    reading_q <= {reading_q[ReadLatency-1:0], reading};

    // banks
    row_wait_q <= activate ? Over - TimerBits'(RowToRow - 1) : row_wait_q[TimerBits-1] ? Over : row_wait_q + 1'b1;
    for (int unsigned bank = 0; bank < 4; bank++) begin
      if (!may_column[bank])
        column_wait_q[TimerBits*bank+:TimerBits] <= column_wait_q[TimerBits*bank+:TimerBits] + 1'b1;
      if (!may_precharge[bank])
        precharge_wait_q[TimerBits*bank+:TimerBits] <= precharge_wait_q[TimerBits*bank+:TimerBits] + 1'b1;
      if (!may_activate[bank])
        activate_wait_q[TimerBits*bank+:TimerBits] <= activate_wait_q[TimerBits*bank+:TimerBits] + 1'b1;
      if (next_bank_q == 2'(bank)) begin
        if (activate) begin
          open_q[bank] <= 1'b1;
          row_q[13*bank+:13] <= next_row_q;
          column_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(RowToColumn - 1);
          precharge_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(RowActive - 1);
        end
        if (precharge) begin
          open_q[bank] <= 1'b0;
          activate_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(Precharge - 1);
        end
        if (write_now && precharge_wait_q[TimerBits*bank+:TimerBits] > Over - TimerBits'(WriteRecovery))
          precharge_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(WriteRecovery);
      end
      if (precharge_all) begin
        open_q[bank] <= 1'b0;
        activate_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(Precharge - 1);
      end
      if (refresh) activate_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(RefreshTime - 1);
      if (load_mode) activate_wait_q[TimerBits*bank+:TimerBits] <= Over - TimerBits'(ModeTime - 1);
    end

    // initialisation and refresh
    if (waiting) wait_q <= wait_q - 1'b1;
    if (precharge_all) precharged_q <= 1'b1;
    if (refresh && !run_q) init_refreshes_q <= init_refreshes_q - 1'b1;
    if (load_mode) mode_set_q <= 1'b1;
    if (!run_q && mode_set_q && may_activate == '1) begin
      run_q <= 1'b1;
      precharged_q <= 1'b0;
    end
    refresh_q <= !run_q || refresh_q == RefreshBits'(RefreshEvery - 1) ? '0 : refresh_q + 1'b1;
    if (RefreshesAhead == 0 ? refresh_q == RefreshBits'(RefreshEvery - 1) : refresh_owed || refresh_early)
      refresh_due_q <= 1'b1;
    if (refresh && run_q) begin
      refresh_due_q <= 1'b0;
      precharged_q <= 1'b0;
    end

    if (rst_i) begin
      gap_q <= '0;
      bursts_q <= '0;
      second_q <= 1'b0;
      reading_q <= '0;
      row_wait_q <= Over;
      column_wait_q <= {4{Over}};
      precharge_wait_q <= {4{Over}};
      activate_wait_q <= {4{Over}};
      open_q <= '0;
      wait_q <= WaitBits'(PowerUp);
      precharged_q <= 1'b0;
      init_refreshes_q <= 4'(InitRefreshes);
      mode_set_q <= 1'b0;
      run_q <= 1'b0;
      refresh_q <= '0;
      refresh_due_q <= 1'b0;
    end
  end

  // ---- refreshes ahead of their time ----
  if (RefreshesAhead == 0) begin : gen_refreshes_in_time
    assign refresh_owed = 1'b0;
    assign refresh_early = 1'b0;
  end else begin : gen_refreshes_ahead
    localparam int unsigned BalanceBits = $clog2(RefreshesAhead + 2);
    logic [BalanceBits-1:0] balance_q;  // refreshes ahead, and 1; 0: one is owed
    logic [3:0] idle_q;  // cycles without a request, data or a refresh, up to 8
    logic room_q;  // for one more
    logic [3:0] intervals_q;  // since the last one
    logic refresh_interval;
    assign refresh_interval = refresh_q == RefreshBits'(RefreshEvery - 1);
    assign refresh_owed = balance_q == '0 || intervals_q == 4'(RowIntervals);
    assign refresh_early = idle_q[3] && room_q;
    always_ff @(posedge clk_i) begin
      idle_q <= !run_q || next_valid_q || bursting || refresh_due_q || may_activate != '1 ? '0 :
          idle_q[3] ? idle_q : idle_q + 1'b1;
      room_q <= balance_q != BalanceBits'(RefreshesAhead + 1);
      if (refresh && run_q && !refresh_interval) balance_q <= balance_q + 1'b1;
      if (refresh_interval && !(refresh && run_q)) balance_q <= balance_q - 1'b1;
      intervals_q <= refresh ? '0 : intervals_q + 4'(refresh_interval);
      if (rst_i) begin
        idle_q <= '0;
        room_q <= 1'b0;
        intervals_q <= '0;
        balance_q <= BalanceBits'(1);
      end
    end
  end

  // ---- data ----
  always_ff @(posedge clk_i) rsp_data_o <= sdram_dq_i;
  assign rsp_valid_o = reading_q[ReadLatency-1];
endmodule
