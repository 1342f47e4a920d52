// SPDX-License-Identifier: Apache-2.0
// A board's power-up self-test: once the photon memory is ready it plays the WRITEs of photonloom_pkg::SelfTestScript into
// the board's registers as the host link would, waits after each until the replayer is idle, and at the end compares number
// and signature of the replayed results with golden's. So it goes through everything that a query goes through, from the
// photon memory to the results. Passed or failed, running_o falls within 2^TimeoutBits cycles of reset, a hang included.
//
// A word takes some 6 cycles, more where the photon memory does. Script and signature: golden/unit/self_test.cpp.
module self_test #(
    parameter int unsigned TimeoutBits = 21
) (
    input  logic        clk_i,
    input  logic        rst_i,
    output logic        running_o,           // from reset on; the link hears nothing meanwhile
    output logic        passed_o,
    output logic        failed_o,
    // to the registers, as from the link
    output logic [31:0] address_o,
    output logic        first_o,
    output logic        write_valid_o,
    output logic        write_last_o,
    output logic [31:0] write_word_o,
    input  logic        write_ready_i,
    input  logic [ 1:0] write_status_i,
    // from memory and replayer
    input  logic        memory_ready_i,
    input  logic        replay_busy_i,
    input  logic [63:0] replay_signature_i,
    input  logic [47:0] replay_results_i
);
  localparam int unsigned Words = photonloom_pkg::SelfTestWords;
  localparam int unsigned Depth = Words > 2 ? Words : 2;
  localparam int unsigned AddressBits = $clog2(Depth + 1);
  localparam int unsigned IndexBits = $clog2(Depth);
  localparam int unsigned SettleCycles = 15;  // from a start to the replayer's busy_o, and to its last results

  typedef enum logic [2:0] {
    Ready,    // is the photon memory?
    Address,
    Count,
    Word,
    Present,  // a word is offered
    Settle,   // the replayer, if this started it
    Done
  } state_t;
  state_t state_q;

  (* ram_style = "block" *) logic [31:0] script[0:Depth-1];
  initial for (int unsigned i = 0; i < Words; i++) script[i] = photonloom_pkg::SelfTestScript[32*i+:32];

  logic [AddressBits-1:0] at_q;
  logic [31:0] word_q, left_q;
  logic [3:0] settle_q;
  logic [TimeoutBits-1:0] time_q;
  logic fetched_q, refused_q, late, right;

  assign running_o = state_q != Done;
  assign late = time_q == '1;
  assign right = !refused_q && replay_results_i == 48'(photonloom_pkg::SelfTestResults) &&
      replay_signature_i == photonloom_pkg::SelfTestSignature;
  assign write_valid_o = state_q == Present;
  assign write_last_o = left_q == 32'd1;

  // word_q is what lies at at_q when fetched_q.
  always_ff @(posedge clk_i) word_q <= script[at_q[IndexBits-1:0]];

  always_ff @(posedge clk_i) begin
    time_q <= time_q + 1'b1;
    fetched_q <= 1'b1;
    unique case (state_q)
      Ready: if (memory_ready_i) state_q <= Address;
      Address:
      if (fetched_q) begin
        address_o <= word_q;
        at_q <= at_q + 1'b1;
        fetched_q <= 1'b0;
        state_q <= Count;
      end
      Count:
      if (fetched_q) begin
        left_q <= word_q;
        first_o <= 1'b1;
        at_q <= at_q + 1'b1;
        fetched_q <= 1'b0;
        state_q <= Word;
      end
      Word:
      if (fetched_q) begin
        write_word_o <= word_q;
        at_q <= at_q + 1'b1;
        fetched_q <= 1'b0;
        state_q <= Present;
      end
      Present:
      if (write_ready_i) begin
        if (write_status_i != 2'd0) refused_q <= 1'b1;
        address_o <= address_o + 32'd1;
        left_q <= left_q - 32'd1;
        first_o <= 1'b0;
        settle_q <= 4'(SettleCycles);
        state_q <= write_last_o ? Settle : Word;
      end
      Settle: begin
        if (settle_q != '0) settle_q <= settle_q - 1'b1;
        else if (!replay_busy_i) begin
          state_q <= at_q == AddressBits'(Words) ? Done : Address;
          if (at_q == AddressBits'(Words)) begin
            passed_o <= right;
            failed_o <= !right;
          end
        end
      end
      default: ;
    endcase
    if (late && state_q != Done) begin
      state_q  <= Done;
      failed_o <= 1'b1;
    end
    if (rst_i) begin
      state_q <= Ready;
      at_q <= '0;
      time_q <= '0;
      fetched_q <= 1'b0;
      refused_q <= 1'b0;
      passed_o <= 1'b0;
      failed_o <= 1'b0;
    end
  end
endmodule
