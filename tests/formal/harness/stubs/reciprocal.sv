// SPDX-License-Identifier: Apache-2.0
// In place of reciprocal where its number does not matter: it gives the low bits of what it took, after any time of at least
// a cycle; as the real one it takes no other until its result is taken. The number that the real one gives, and that it gives
// one, is proved by itself.
module reciprocal #(
    parameter int unsigned XBits = 34,
    parameter int unsigned W = 18,
    localparam int unsigned ExponentBits = $clog2(XBits + 1)
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    input  logic                    in_valid_i,
    output logic                    in_ready_o,
    input  logic [       XBits-1:0] in_i,
    output logic                    out_valid_o,
    input  logic                    out_ready_i,
    output logic [             W:0] mantissa_o,
    output logic [ExponentBits-1:0] exponent_o
);
  localparam logic [1:0] Idle = 2'd0, Busy = 2'd1, Out = 2'd2;
  (* anyseq *) logic ends;
  logic [1:0] state_q;
  logic [XBits-1:0] word_q;
  assign in_ready_o = state_q == Idle;
  assign out_valid_o = state_q == Out;
  assign mantissa_o = word_q[W:0];
  assign exponent_o = '0;
  always_ff @(posedge clk_i) begin
    case (state_q)
      Idle: begin
        word_q <= in_i;
        if (in_valid_i) state_q <= Busy;
      end
      Busy: if (ends) state_q <= Out;
      default: if (out_ready_i) state_q <= Idle;
    endcase
    if (rst_i) state_q <= Idle;
  end
endmodule
