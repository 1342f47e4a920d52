// SPDX-License-Identifier: Apache-2.0
// The address space of docs/host-link.md: reads registers and counters, writes registers, configuration, photon lines and
// the replayer's queries, and starts a new session: drops what waits, lets what is inside come out, sets the streams back.
//
// Reads: word_o follows address_i by 3 cycles. Writes: held until write_ready_o, 3 cycles, longer where the photon memory
// or a new session takes longer.
module board_registers #(
    parameter int unsigned ClockKHz = 0,
    parameter int unsigned RxBytes = 2048
) (
    input  logic        clk_i,
    input  logic        rst_i,
    // from the link
    input  logic [31:0] address_i,
    input  logic        first_i,
    input  logic        read_valid_i,
    output logic [31:0] word_o,
    input  logic        write_valid_i,
    output logic        write_ready_o,
    output logic [ 1:0] write_status_o,
    input  logic [31:0] write_word_i,
    input  logic        write_last_i,
    input  logic        byte_lost_i,
    input  logic        frame_bad_i,
    // streams
    output logic        clear_input_o,
    output logic        discard_o,           // results and photons
    output logic        clear_output_o,
    input  logic        input_busy_i,
    input  logic [15:0] input_room_i,
    input  logic [31:0] input_position_i,
    input  logic [31:0] output_first_i,
    input  logic [31:0] output_end_i,
    // engine
    input  logic        engine_busy_i,
    input  logic        memory_ready_i,
    output logic        cfg_valid_o,
    output logic [23:0] cfg_addr_o,
    output logic [63:0] cfg_data_o,
    output logic        line_valid_o,
    input  logic        line_ready_i,
    output logic [27:0] line_address_o,
    output logic [31:0] line_word_o,
    // replayer
    output logic        query_valid_o,       // a word of its queries, at line_address_o
    output logic        start_o,
    output logic        stop_o,
    output logic [31:0] queries_o,
    output logic [31:0] passes_o,
    output logic [ 1:0] mode_o,
    input  logic        replay_busy_i,
    input  logic [47:0] replay_cycles_i,
    input  logic [63:0] replay_signature_i,
    input  logic [47:0] replay_results_i,
    // 12 counters of 40 bits in the order of the specification, the first lowest
    input  logic [479:0] counters_i,
    input  logic [ 31:0] faults_i,           // words of memory that were not right
    input  logic [  1:0] self_test_i,        // 0 none, 1 running, 2 passed, 3 failed
    // for the LEDs
    output logic        busy_o,              // queries inside
    output logic        bad_seen_o,
    output logic        plan_read_o
);
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalPresent == 0 ? 0 :
      (photonloom_pkg::GlobalPhotons + photonloom_pkg::Bucket - 1) / photonloom_pkg::Bucket;
  localparam int unsigned CausticLines = photonloom_pkg::CausticPresent == 0 ? 0 :
      (photonloom_pkg::CausticPhotons + photonloom_pkg::Bucket - 1) / photonloom_pkg::Bucket;
  localparam int unsigned Nodes = GlobalLines + CausticLines;
  // Behind the leaves' lines of each map there may be room for further ones. A line has whole words.
  localparam int unsigned LineWords = (photonloom_pkg::GlobalMemoryLines + photonloom_pkg::CausticMemoryLines) *
      (photonloom_pkg::Bucket * photonloom_pkg::PhotonBytes / 4);
  localparam int unsigned QueryWords = (photonloom_pkg::GatherQueryPacketBits + 31) / 32;
  localparam int unsigned QueryStride = 1 << $clog2(QueryWords);

  localparam logic [3:0] Registers = 4'd0;
  localparam logic [3:0] Configuration = 4'd1;
  localparam logic [3:0] Lines = 4'd2;
  localparam logic [3:0] Queries = 4'd3;

  logic [31:0] session_q, control_q, queries_q, passes_q;
  logic [15:0] bad_q, lost_q;
  logic [1:0] mode_q;
  assign queries_o = queries_q;
  assign passes_o  = passes_q;
  assign mode_o    = mode_q;
  assign busy_o    = input_busy_i || engine_busy_i;

  // ---- reads: two words at a time, so that both are of one moment when one READ asks for both ----
  // Selects are registers and gate what they select, which takes a third of the logic of a multiplexer.
  logic [63:0] pair, pair_q;
  logic [31:0] select_q;
  always_ff @(posedge clk_i) select_q <= 32'd1 << address_i[5:1];
  always_comb begin
    pair = '0;
    if (select_q[0]) pair = pair | {32'd1, 32'h4D4C4850};
    if (select_q[1]) pair = pair | photonloom_pkg::PlanHash;
    if (select_q[2]) pair = pair | {32'(photonloom_pkg::Gatherers), session_q};
    if (select_q[3]) pair = pair | {16'd0, input_room_i, 32'(RxBytes)};
    if (select_q[4]) pair = pair | {output_first_i, input_position_i};
    if (select_q[5]) pair = pair | {32'(ClockKHz), output_end_i};
    if (select_q[6]) pair = pair | {16'd0, bad_q, 29'd0, replay_busy_i, memory_ready_i, busy_o};
    if (select_q[7]) pair = pair | 64'(lost_q);
    if (select_q[8]) pair = pair | {queries_q, control_q};
    if (select_q[9]) pair = pair | {30'd0, mode_q, passes_q};
    if (select_q[10]) pair = pair | 64'(replay_cycles_i);
    if (select_q[11]) pair = pair | replay_signature_i;
    if (select_q[12]) pair = pair | 64'(replay_results_i);
    if (select_q[13]) pair = pair | {faults_i, 30'd0, self_test_i};
    for (int unsigned i = 0; i < 12; i++) if (select_q[16+i]) pair = pair | 64'(counters_i[40*i+:40]);
  end

  logic register_q;
  always_ff @(posedge clk_i) begin
    if (first_i || !address_i[0]) pair_q <= pair;
    register_q <= address_i[31:6] == '0;
    word_o <= !register_q ? 32'd0 : address_i[0] ? pair_q[63:32] : pair_q[31:0];
    if (read_valid_i && register_q && address_i[5:1] == 5'd1) plan_read_o <= 1'b1;
    if (byte_lost_i) lost_q <= lost_q + 16'd1;
    if (frame_bad_i) bad_q <= bad_q + 16'd1;
    if (frame_bad_i) bad_seen_o <= 1'b1;
    if (rst_i) begin
      plan_read_o <= 1'b0;
      bad_seen_o <= 1'b0;
      lost_q <= '0;
      bad_q <= '0;
    end
  end

  // ---- writes ----
  typedef enum logic [2:0] {
    Idle,
    Decide,
    Line,   // the photon memory takes a word
    Drain,  // a new session: what is inside comes out
    Clear,
    Done
  } state_t;
  state_t state_q;

  // What the word and its address are, a cycle later.
  logic in_registers_q, in_cfg_q, in_lines_q, in_queries_q;
  logic zero_q, same_session_q, same_control_q, queries_good_q, quiet_q, busy_q;
  logic cfg_good_q, line_good_q, query_good_q;
  logic [22:0] high_cfg;
  assign high_cfg = address_i[23:1];

  always_ff @(posedge clk_i) begin
    in_registers_q <= address_i[31:28] == Registers && address_i[27:6] == '0;
    in_cfg_q <= address_i[31:28] == Configuration;
    in_lines_q <= address_i[31:28] == Lines;
    in_queries_q <= address_i[31:28] == Queries;
    zero_q <= write_word_i == '0;
    same_session_q <= write_word_i == session_q;
    same_control_q <= write_word_i == control_q;
    queries_good_q <= write_word_i != '0 && write_word_i <= 32'(photonloom_pkg::ReplayQueries);
    // Whole pairs, of a node or of one of the five registers behind address 0x800000.
    cfg_good_q <= (address_i[0] ? !first_i : !write_last_i) && address_i[27:25] == '0 &&
        (address_i[24] ? high_cfg < 23'd5 : Nodes >= 32'h80_0000 || high_cfg < 23'(Nodes));
    line_good_q <= address_i[27:0] < 28'(LineWords);
    query_good_q <= address_i[27:0] < 28'(photonloom_pkg::ReplayQueries * QueryStride);
    busy_q <= busy_o || replay_busy_i;
    quiet_q <= state_q == Drain && !busy_o && !replay_busy_i;
  end

  assign write_ready_o = state_q == Done;
  assign clear_input_o = state_q == Drain || state_q == Clear;
  assign discard_o = state_q == Drain || state_q == Clear;
  assign clear_output_o = state_q == Clear;
  assign line_address_o = address_i[27:0];
  assign line_word_o = write_word_i;
  assign line_valid_o = state_q == Line;
  assign cfg_addr_o = address_i[24:1];

  always_ff @(posedge clk_i) begin
    start_o <= 1'b0;
    stop_o <= 1'b0;
    cfg_valid_o <= 1'b0;
    query_valid_o <= 1'b0;
    unique case (state_q)
      Idle: begin
        write_status_o <= 2'd0;
        if (write_valid_i) state_q <= Decide;
      end
      Decide: begin
        state_q <= Done;
        if (in_registers_q && address_i[5:0] == 6'd4) begin
          if (!same_session_q) state_q <= Drain;
        end else if (in_registers_q && address_i[5:0] == 6'd16) begin
          if (zero_q) begin
            control_q <= '0;
            stop_o <= 1'b1;
          end else if (!same_control_q) begin
            if (busy_q) write_status_o <= 2'd2;
            else if (queries_q == '0 || passes_q == '0) write_status_o <= 2'd1;
            else begin
              control_q <= write_word_i;
              start_o   <= 1'b1;
            end
          end
        end else if (in_registers_q && address_i[5:2] == 4'b0100) begin
          if (busy_q) write_status_o <= 2'd2;
          else
            unique case (address_i[1:0])
              2'd1: begin
                if (queries_good_q) queries_q <= write_word_i;
                else write_status_o <= 2'd1;
              end
              2'd2: begin
                if (!zero_q) passes_q <= write_word_i;
                else write_status_o <= 2'd1;
              end
              default: mode_q <= write_word_i[1:0];
            endcase
        end else if (in_cfg_q && cfg_good_q) begin
          if (busy_q) write_status_o <= 2'd2;
          else begin
            if (address_i[0]) cfg_data_o[63:32] <= write_word_i;
            else cfg_data_o[31:0] <= write_word_i;
            cfg_valid_o <= address_i[0];
          end
        end else if (in_lines_q && line_good_q) begin
          if (busy_q) write_status_o <= 2'd2;
          else state_q <= Line;
        end else if (in_queries_q && query_good_q) begin
          if (busy_q) write_status_o <= 2'd2;
          else query_valid_o <= 1'b1;
        end else begin
          write_status_o <= 2'd1;
        end
      end
      Line: if (line_ready_i) state_q <= Done;
      Drain: begin
        stop_o <= 1'b1;
        control_q <= '0;
        if (quiet_q) state_q <= Clear;
      end
      Clear: begin
        session_q <= write_word_i;
        state_q   <= Done;
      end
      default: state_q <= Idle;
    endcase
    if (rst_i) begin
      state_q <= Idle;
      session_q <= '0;
      control_q <= '0;
      queries_q <= '0;
      passes_q <= '0;
      mode_q <= '0;
    end
  end
endmodule
