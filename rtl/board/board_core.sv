// SPDX-License-Identifier: Apache-2.0
// Everything of a board but its pins: the host link, its registers and streams, the query replayer, and the gatherers with
// their photon memory. docs/host-link.md is what a host sees; the plan is photonloom_pkg's.
//
// ClocksPerBit: core clocks a UART bit, at least 4. ClockKHz: the core's clock, for a register and the LEDs; 0 in simulation.
module board_core #(
    parameter int unsigned ClocksPerBit = 4,
    parameter int unsigned ClockKHz = 0
) (
    input  logic        clk_i,  // clock
    input  logic        rst_i,  // reset, synchronous
    // host link
    input  logic        uart_rx_i,  // serial line from the host
    output logic        uart_tx_o,  // serial line to the host
    output logic [ 7:0] led_o,          // 1 is lit
    // SDRAM, in the domain of clk_sdram_i; without one in the plan its pins rest
    input  logic        clk_sdram_i,  // clock of the SDRAM's pins
    output logic        sdram_cke_o,  // clock enable
    output logic        sdram_cs_no,  // chip select, active low
    output logic        sdram_ras_no,  // row address strobe, active low
    output logic        sdram_cas_no,  // column address strobe, active low
    output logic        sdram_we_no,  // write enable, active low
    output logic [ 1:0] sdram_ba_o,  // bank
    output logic [12:0] sdram_a_o,  // row or column address
    output logic [ 1:0] sdram_dqm_o,  // byte masks
    input  logic [15:0] sdram_dq_i,  // data from the chip
    output logic [15:0] sdram_dq_o,  // data to the chip
    output logic        sdram_dq_oe_o  // data pins are driven
);
  localparam int unsigned RxBytes = 2048;
  localparam int unsigned InputWords = 512;
  localparam int unsigned OutputWords = 1024;

  // ---- link ----
  logic byte_received, byte_sent, byte_lost, frame_bad;
  logic [31:0] link_address, link_word, read_word, push_word, push_position, pull_first, pull_end, pull_word;
  logic link_first, read_valid, link_valid, link_ready, link_last, push_valid;
  logic [ 1:0] write_status;
  logic [15:0] push_room;
  logic keep_valid, pull_before, pull_after;
  logic testing, test_passed, test_failed, first, write_valid, write_ready, write_last;
  logic [31:0] address, write_word;
  host_link #(
      .ClocksPerBit(ClocksPerBit),
      .RxBytes(RxBytes)
  ) link (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .uart_rx_i(uart_rx_i || testing),
      .uart_tx_o(uart_tx_o),
      .byte_received_o(byte_received),
      .byte_sent_o(byte_sent),
      .byte_lost_o(byte_lost),
      .frame_bad_o(frame_bad),
      .address_o(link_address),
      .first_o(link_first),
      .read_valid_o(read_valid),
      .read_word_i(read_word),
      .write_valid_o(link_valid),
      .write_ready_i(link_ready),
      .write_status_i(write_status),
      .write_word_o(link_word),
      .write_last_o(link_last),
      .push_valid_o(push_valid),
      .push_word_o(push_word),
      .push_position_i(push_position),
      .push_room_i(push_room),
      .keep_valid_o(keep_valid),
      .pull_before_i(pull_before),
      .pull_after_i(pull_after),
      .pull_first_i(pull_first),
      .pull_end_i(pull_end),
      .pull_word_i(pull_word)
  );

  // ---- address space ----
  logic clear_input, discard, clear_output, input_busy, engine_busy, memory_ready, busy, bad_seen, plan_read;
  logic cfg_valid, line_valid, line_ready, replay_write, replay_start, replay_stop, replay_busy;
  logic [23:0] cfg_addr;
  logic [63:0] cfg_data, replay_signature;
  logic [47:0] replay_cycles, replay_results;
  logic [27:0] line_address;
  logic [31:0] line_word, replay_queries, replay_passes;
  logic [1:0] replay_mode;
  logic [479:0] counters;
  logic [31:0] faults;

  // ---- power-up self-test: until it is through the link hears nothing ----
  if (photonloom_pkg::SelfTest != 0) begin : gen_self_test
    logic test_first, test_valid, test_last;
    logic [31:0] test_address, test_word;
    self_test test (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .running_o(testing),
        .passed_o(test_passed),
        .failed_o(test_failed),
        .address_o(test_address),
        .first_o(test_first),
        .write_valid_o(test_valid),
        .write_last_o(test_last),
        .write_word_o(test_word),
        .write_ready_i(write_ready && testing),
        .write_status_i(write_status),
        .memory_ready_i(memory_ready),
        .replay_busy_i(replay_busy),
        .replay_signature_i(replay_signature),
        .replay_results_i(replay_results)
    );
    assign address = testing ? test_address : link_address;
    assign first = testing ? test_first : link_first;
    assign write_valid = testing ? test_valid : link_valid;
    assign write_word = testing ? test_word : link_word;
    assign write_last = testing ? test_last : link_last;
    assign link_ready = write_ready && !testing;
  end else begin : gen_no_self_test
    assign {testing, test_passed, test_failed} = '0;
    assign address = link_address;
    assign first = link_first;
    assign write_valid = link_valid;
    assign write_word = link_word;
    assign write_last = link_last;
    assign link_ready = write_ready;
  end

  board_registers #(
      .ClockKHz(ClockKHz),
      .RxBytes(RxBytes)
  ) registers (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .address_i(address),
      .first_i(first),
      .read_valid_i(read_valid),
      .word_o(read_word),
      .write_valid_i(write_valid),
      .write_ready_o(write_ready),
      .write_status_o(write_status),
      .write_word_i(write_word),
      .write_last_i(write_last),
      .byte_lost_i(byte_lost),
      .frame_bad_i(frame_bad),
      .clear_input_o(clear_input),
      .discard_o(discard),
      .clear_output_o(clear_output),
      .input_busy_i(input_busy),
      .input_room_i(push_room),
      .input_position_i(push_position),
      .output_first_i(pull_first),
      .output_end_i(pull_end),
      .engine_busy_i(engine_busy),
      .memory_ready_i(memory_ready),
      .cfg_valid_o(cfg_valid),
      .cfg_addr_o(cfg_addr),
      .cfg_data_o(cfg_data),
      .line_valid_o(line_valid),
      .line_ready_i(line_ready),
      .line_address_o(line_address),
      .line_word_o(line_word),
      .query_valid_o(replay_write),
      .start_o(replay_start),
      .stop_o(replay_stop),
      .queries_o(replay_queries),
      .passes_o(replay_passes),
      .mode_o(replay_mode),
      .replay_busy_i(replay_busy),
      .replay_cycles_i(replay_cycles),
      .replay_signature_i(replay_signature),
      .replay_results_i(replay_results),
      .counters_i(counters),
      .faults_i(faults),
      .self_test_i({test_passed || test_failed, testing || test_failed}),
      .busy_o(busy),
      .bad_seen_o(bad_seen),
      .plan_read_o(plan_read)
  );

  // ---- streams ----
  logic stream_valid, stream_ready;
  photonloom_pkg::gather_query_t stream_query;
  query_words #(
      .Depth(InputWords)
  ) input_stream (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_input),
      .hold_i(replay_busy),
      .in_valid_i(push_valid),
      .in_i(push_word),
      .position_o(push_position),
      .room_o(push_room),
      .busy_o(input_busy),
      .out_valid_o(stream_valid),
      .out_ready_i(stream_ready),
      .out_o(stream_query)
  );

  logic result_valid, record_result_ready, photon_valid, record_photon_ready;
  photonloom_pkg::gather_result_t result;
  photonloom_pkg::gather_photon_t photon;
  record_words #(
      .Depth(OutputWords)
  ) output_stream (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear_output),
      .discard_i(discard),
      .result_valid_i(result_valid && !replay_busy),
      .result_ready_o(record_result_ready),
      .result_i(result),
      .photon_valid_i(photon_valid),
      .photon_ready_o(record_photon_ready),
      .photon_i(photon),
      .position_i(link_address),
      .keep_valid_i(keep_valid),
      .before_o(pull_before),
      .after_o(pull_after),
      .word_o(pull_word),
      .first_o(pull_first),
      .end_o(pull_end)
  );

  // ---- replayer: while it is busy queries and results are its own ----
  logic replay_forget, replay_valid, reorder;
  photonloom_pkg::gather_query_t replay_query;
  query_replayer replayer (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .write_valid_i(replay_write),
      .write_address_i(line_address),
      .write_word_i(line_word),
      .start_i(replay_start),
      .stop_i(replay_stop),
      .queries_i(replay_queries),
      .passes_i(replay_passes),
      .mode_i(replay_mode),
      .busy_o(replay_busy),
      .reorder_o(reorder),
      .forget_o(replay_forget),
      .cluster_busy_i(engine_busy),
      .query_valid_o(replay_valid),
      .query_ready_i(query_ready && replay_busy),
      .query_o(replay_query),
      .result_valid_i(result_valid && replay_busy),
      .result_i(result),
      .cycles_o(replay_cycles),
      .signature_o(replay_signature),
      .results_o(replay_results)
  );

  // ---- gatherers ----
  logic query_ready;
  assign stream_ready = query_ready && !replay_busy;
  gather_engine engine (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .reorder_i(reorder),
      .in_valid_i(replay_busy ? replay_valid : stream_valid),
      .in_ready_o(query_ready),
      .in_i(replay_busy ? replay_query : stream_query),
      .result_valid_o(result_valid),
      .result_ready_i(replay_busy || record_result_ready),
      .result_o(result),
      .photon_valid_o(photon_valid),
      .photon_ready_i(record_photon_ready),
      .photon_o(photon),
      .cfg_valid_i(cfg_valid || replay_forget),
      .cfg_addr_i(replay_busy ? 24'd0 : cfg_addr),
      .cfg_data_i(cfg_data),
      .write_valid_i(line_valid),
      .write_ready_o(line_ready),
      .write_address_i(line_address),
      .write_data_i(line_word),
      .memory_ready_o(memory_ready),
      .busy_o(engine_busy),
      .clk_sdram_i(clk_sdram_i),
      .sdram_cke_o(sdram_cke_o),
      .sdram_cs_no(sdram_cs_no),
      .sdram_ras_no(sdram_ras_no),
      .sdram_cas_no(sdram_cas_no),
      .sdram_we_no(sdram_we_no),
      .sdram_ba_o(sdram_ba_o),
      .sdram_a_o(sdram_a_o),
      .sdram_dqm_o(sdram_dqm_o),
      .sdram_dq_i(sdram_dq_i),
      .sdram_dq_o(sdram_dq_o),
      .sdram_dq_oe_o(sdram_dq_oe_o),
      .count_busy_o(counters[40*0+:40]),
      .count_queries_o(counters[40*1+:40]),
      .count_nodes_o(counters[40*2+:40]),
      .count_leaves_o(counters[40*3+:40]),
      .count_insertions_o(counters[40*4+:40]),
      .count_lines_o(counters[40*5+:40]),
      .count_stalled_in_o(counters[40*6+:40]),
      .count_stalled_results_o(counters[40*7+:40]),
      .count_stalled_photons_o(counters[40*8+:40]),
      .count_reordered_o(counters[40*9+:40]),
      .count_memory_lines_o(counters[40*10+:40]),
      .count_memory_busy_o(counters[40*11+:40]),
      .count_faults_o(faults)
  );

  logic memory_count_q;
  always_ff @(posedge clk_i) memory_count_q <= counters[40*11];
  board_leds #(
      .ClockKHz(ClockKHz)
  ) leds (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .byte_received_i(byte_received),
      .byte_sent_i(byte_sent),
      .busy_i(busy),
      .replay_busy_i(replay_busy),
      .memory_busy_i(memory_count_q != counters[40*11]),
      .bad_seen_i(bad_seen),
      .plan_read_i(plan_read),
      .testing_i(testing),
      .test_failed_i(test_failed),
      .led_o(led_o)
  );
endmodule
