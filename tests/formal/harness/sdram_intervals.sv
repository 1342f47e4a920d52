// SPDX-License-Identifier: Apache-2.0
// sources: rtl/board/sdram_controller.sv
// sdram_controller: no command comes inside an interval that the data sheet forbids, no row is read or written that is not
// open, and nobody drives the data pins against the chip. The times, in ns, are written down here from the data sheet and
// turned into cycles here; the commands are read from the chip's pins. One bank, any, is watched. Requests are free.
// Refreshes fall due at any time, but only 16 cycles after the last one was made; each is asserted to be made within RefreshWithin
// cycles, what a line, a PRECHARGE and all else under way may take; properties of that are deep enough for one that is not. With RefreshesAhead one is owed when more fell due than were made,
// or RowIntervals fell due since the last one; they fall due 24 cycles apart at least and 16 after one that was owed or
// of the initialisation, whenever others were made, and those made are asserted to be so many ahead at most. With Pause 1 instead: no command in the first 200 us, counted out.
module sdram_intervals #(
    parameter int unsigned ClockKHz = 100000,
    parameter int unsigned LineHalfwords = 16,
    parameter int unsigned Pause = 0,
    parameter int unsigned RefreshesAhead = 0,
    parameter int unsigned RowIntervals = 11,
    parameter int unsigned RefreshWithin = LineHalfwords + 8
) (
    input logic clk_i,
    input logic rst_i,
    input logic req_valid_i,
    input logic req_write_i,
    input logic [23:0] req_address_i
);
  (* anyconst *) logic [1:0] bank;

  logic ready, req_ready, cke, cs_n, ras_n, cas_n, we_n, dq_oe, rsp_valid;
  logic [ 1:0] ba;
  logic [12:0] a;

  sdram_controller #(
      .ClockKHz(ClockKHz),
      .LineHalfwords(LineHalfwords),
      .RefreshesAhead(RefreshesAhead),
      .RowIntervals(RowIntervals)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready),
      .req_valid_i(req_valid_i),
      .req_ready_o(req_ready),
      .req_write_i(req_write_i),
      .req_address_i(req_address_i),
      .req_data_i(32'd0),
      .rsp_valid_o(rsp_valid),
      .rsp_data_o(),
      .sdram_cke_o(cke),
      .sdram_cs_no(cs_n),
      .sdram_ras_no(ras_n),
      .sdram_cas_no(cas_n),
      .sdram_we_no(we_n),
      .sdram_ba_o(ba),
      .sdram_a_o(a),
      .sdram_dqm_o(),
      .sdram_dq_i(16'd0),
      .sdram_dq_o(),
      .sdram_dq_oe_o(dq_oe)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  function automatic int unsigned cycles(input int unsigned ns);
    cycles = (ns * ClockKHz + 999999) / 1000000;
  endfunction
  // Not looked at with Pause, whose slow clock would make them one cycle.
  localparam int unsigned Trcd = Pause == 1 ? 2 : cycles(21);  // ACTIVATE to READ or WRITE
  localparam int unsigned Trp = Pause == 1 ? 2 : cycles(21);  // PRECHARGE to ACTIVATE or AUTO REFRESH
  localparam int unsigned Tras = Pause == 1 ? 2 : cycles(44);  // ACTIVATE to PRECHARGE
  localparam int unsigned Trrd = Pause == 1 ? 2 : cycles(15);  // ACTIVATE to ACTIVATE of another bank
  localparam int unsigned Twr = Pause == 1 ? 2 : cycles(15);  // WRITE to PRECHARGE
  localparam int unsigned Trfc = Pause == 1 ? 2 : cycles(66);  // AUTO REFRESH to any but NOP
  localparam int unsigned Tmrd = 2;  // LOAD MODE to any but NOP
  localparam int unsigned Burst = 8;
  localparam int unsigned Cas = 3;

  logic activate, read, write, precharge, refresh, load_mode, mine, mine_or_all;
  assign activate = {cs_n, ras_n, cas_n, we_n} == 4'b0011;
  assign read = {cs_n, ras_n, cas_n, we_n} == 4'b0101;
  assign write = {cs_n, ras_n, cas_n, we_n} == 4'b0100;
  assign precharge = {cs_n, ras_n, cas_n, we_n} == 4'b0010;
  assign refresh = {cs_n, ras_n, cas_n, we_n} == 4'b0001;
  assign load_mode = {cs_n, ras_n, cas_n, we_n} == 4'b0000;
  assign mine = ba == bank;
  assign mine_or_all = mine || a[10];

  // A refresh falls due, and is not made yet.
  localparam int unsigned RefreshEvery =
      (RefreshesAhead == 0 ? 7800 : 64000000 / (8193 + RefreshesAhead)) * (ClockKHz / 1000) / 1000;
  localparam int unsigned RefreshBits = $clog2(RefreshEvery);
  logic [RefreshBits-1:0] refresh_count;  // probe: the controller's own, and any value
  logic falls_due, due_q;
  logic [8:0] ahead_q;
  logic [3:0] intervals_q;
  logic [4:0] since_due_q;  // cycles, up to 24
  logic [15:0] paid_q;  // a refresh that was owed, or of the initialisation
  logic ready_q, paid;
  assign paid = refresh && (due_q || row_old || !ready_q);
  logic row_old;
  assign row_old = RefreshesAhead != 0 && intervals_q == 4'(RowIntervals);
  logic [9:0] due_age_q;
  logic waits;  // probe: the controller pauses, which is cut to be at any time; but it is over before it is ready, and only a reset begins another
  assign falls_due = ready && refresh_count == RefreshBits'(RefreshEvery - 1);
  always_ff @(posedge clk_i) begin
    if (refresh) due_q <= 1'b0;
    if (falls_due && ahead_q == '0) due_q <= !(refresh && !due_q);
    if (RefreshesAhead != 0 && ready_q)
      ahead_q <= ahead_q + 9'(refresh && !due_q) - 9'(falls_due && (ahead_q != '0 || (refresh && !due_q)));
    since_due_q <= falls_due ? '0 : since_due_q[4:3] == 2'b11 ? since_due_q : since_due_q + 1'b1;
    paid_q <= {paid_q[14:0], paid};
    ready_q <= ready;
    intervals_q <= refresh ? '0 : intervals_q + 4'(falls_due);
    due_age_q <= (due_q || row_old) && !refresh ? due_age_q + 1'b1 : '0;
    if (rst_i) begin
      due_q <= 1'b0;
      due_age_q <= '0;
      ahead_q <= '0;
      intervals_q <= '0;
      since_due_q <= '0;
      paid_q <= '0;
      ready_q <= 1'b0;
    end
  end

  if (Pause == 1) begin : gen_pause
    localparam int unsigned PauseCycles = cycles(200000);
    localparam int unsigned Bits = $clog2(PauseCycles + 1);
    logic [Bits-1:0] age_q = '0;
    always_ff @(posedge clk_i) if (age_q != Bits'(PauseCycles)) age_q <= age_q + 1'b1;
    always_comb if (age_q != Bits'(PauseCycles)) assert (!activate && !read && !write && !precharge && !refresh && !load_mode);
  end

  // Cycles since a command as one bit each: bit n is n + 1 cycles ago. Of the watched bank, or of any.
  // within(n): those after which n cycles have not passed, none of 1.
  function automatic logic [15:0] within(input int unsigned n);
    within = (16'd1 << (n - 1)) - 16'd1;
  endfunction
  logic [15:0] activate_q, any_activate_q, write_q, any_write_q, read_q, any_read_q, precharge_q, refresh_q, load_q;
  logic open_q;
  always_ff @(posedge clk_i) begin
    activate_q <= {activate_q[14:0], activate && mine};
    any_activate_q <= {any_activate_q[14:0], activate};
    write_q <= {write_q[14:0], write && mine};
    any_write_q <= {any_write_q[14:0], write};
    read_q <= {read_q[14:0], read && mine};
    any_read_q <= {any_read_q[14:0], read};
    precharge_q <= {precharge_q[14:0], precharge && mine_or_all};
    refresh_q <= {refresh_q[14:0], refresh};
    load_q <= {load_q[14:0], load_mode};
    if (activate && mine) open_q <= 1'b1;
    if (precharge && mine_or_all) open_q <= 1'b0;
    if (rst_i) begin
      activate_q <= '0;
      any_activate_q <= '0;
      write_q <= '0;
      any_write_q <= '0;
      read_q <= '0;
      any_read_q <= '0;
      precharge_q <= '0;
      refresh_q <= '0;
      load_q <= '0;
      open_q <= 1'b0;
    end
  end

  always_comb begin
    if (!rst_i && Pause == 0) begin
      assume (!(refresh_count == RefreshBits'(RefreshEvery - 1) &&
          (!ready || due_q || row_old ||
          (RefreshesAhead == 0 ? refresh || refresh_q != '0 : since_due_q[4:3] != 2'b11 || paid || paid_q != '0))));
      assume (!(ready && waits));
      assert (due_age_q != 10'(RefreshWithin));
      assert (ahead_q <= 9'(RefreshesAhead));
    end
    if (!rst_i && started_q && Pause == 0) begin
      if (activate && mine) assert (!open_q && (precharge_q & within(Trp)) == '0);
      if (activate) assert ((any_activate_q & within(Trrd)) == '0);
      if ((read || write) && mine) assert (open_q && (activate_q & within(Trcd)) == '0);
      if ((read || write) && mine) assert (!a[10]);  // no auto precharge
      if (precharge && mine_or_all) begin
        assert ((activate_q & within(Tras)) == '0);
        assert ((write_q & within(Twr)) == '0);
        assert ((read_q & within(Burst)) == '0);
      end
      // Bursts run to their end, and a word is driven only when the chip has let go of the pins.
      if (read) assert ((any_read_q & within(Burst)) == '0);
      if (write) assert ((any_read_q & within(Burst+Cas)) == '0);
      if (dq_oe) assert (write);
      if (refresh || load_mode) assert (!open_q && (precharge_q & within(Trp)) == '0);
      if (activate || read || write || precharge || refresh || load_mode) begin
        assert ((refresh_q & within(Trfc)) == '0);
        assert ((load_q & within(Tmrd)) == '0);
        assert (cke);
      end
    end
  end
endmodule
