// SPDX-License-Identifier: Apache-2.0
// First in, first out, in LUT RAM; Depth a power of two, at least 2. Latency 1, one word a cycle; in_ready_o and
// out_valid_o come from registers, so no path leads from one side's ready to the other's.
//
// Ahead: while there is room in_i is written in every cycle, and in_valid_i only says whether it stays. So in_valid_i may be
// late; it does not go to every bit's write enable.
//
// ValidAhead: whether it holds a word is a register, where it is else a comparison of both pointers.
module fifo #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 16,
    parameter int unsigned Ahead = 0,
    parameter bit ValidAhead = 1'b0
) (
    input  logic             clk_i,
    input  logic             rst_i,
    input  logic             in_valid_i,
    output logic             in_ready_o,
    input  logic [Width-1:0] in_i,
    output logic             out_valid_o,
    input  logic             out_ready_i,
    output logic [Width-1:0] out_o
);
  localparam int unsigned AddressBits = $clog2(Depth);

  if (Depth < 2 || (1 << AddressBits) != Depth) begin : gen_bad_depth
    fifo_depth_must_be_a_power_of_two_of_at_least_2 bad_depth ();
  end

  logic [AddressBits:0] head_q, tail_q;
  logic push, pop;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic valid_q;  // where ValidAhead
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  assign in_ready_o = head_q != {~tail_q[AddressBits], tail_q[AddressBits-1:0]};
  assign out_valid_o = ValidAhead ? valid_q : head_q != tail_q;
  assign push = in_valid_i && in_ready_o;
  assign pop = out_valid_o && out_ready_i;

  if (ValidAhead) begin : gen_valid_ahead
    logic last;
    assign last = tail_q == head_q + 1'b1;
    always_ff @(posedge clk_i) valid_q <= !rst_i && (push || (valid_q && !(pop && last)));
  end

  lut_ram #(
      .Width(Width),
      .Depth(Depth)
  ) store (
      .clk_i(clk_i),
      .write_i(Ahead != 0 ? in_ready_o : push),
      .write_address_i(tail_q[AddressBits-1:0]),
      .write_data_i(in_i),
      .read_address_i(head_q[AddressBits-1:0]),
      .read_data_o(out_o)
  );

  always_ff @(posedge clk_i) begin
    if (push) tail_q <= tail_q + 1'b1;
    if (pop) head_q <= head_q + 1'b1;
    if (rst_i) begin
      head_q <= '0;
      tail_q <= '0;
    end
  end
endmodule
