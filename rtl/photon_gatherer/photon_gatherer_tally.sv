// SPDX-License-Identifier: Apache-2.0
// A number for each context: a step sets it from its present value, combinationally shown, and clearing takes no port
// of the memory. A clear and a step of the same context never coincide.
module photon_gatherer_tally #(
    parameter int unsigned Width = 14,
    parameter int unsigned Contexts = 16,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1
) (
    input  logic                   clk_i,
    input  logic                   clear_i,
    input  logic [ContextBits-1:0] clear_context_i,
    input  logic                   step_i,
    input  logic [ContextBits-1:0] step_context_i,
    output logic [      Width-1:0] step_value_o,     // before the step
    input  logic [      Width-1:0] step_next_i,
    input  logic [ContextBits-1:0] read_context_i,
    output logic [      Width-1:0] read_value_o
);
  logic [Contexts-1:0] zero_q;
  logic [Width-1:0] step_stored, read_stored;

  lut_ram #(
      .Width(Width),
      .Depth(Contexts)
  ) for_step (
      .clk_i(clk_i),
      .write_i(step_i),
      .write_address_i(step_context_i),
      .write_data_i(step_next_i),
      .read_address_i(step_context_i),
      .read_data_o(step_stored)
  );
  lut_ram #(
      .Width(Width),
      .Depth(Contexts)
  ) for_read (
      .clk_i(clk_i),
      .write_i(step_i),
      .write_address_i(step_context_i),
      .write_data_i(step_next_i),
      .read_address_i(read_context_i),
      .read_data_o(read_stored)
  );

  assign step_value_o = zero_q[step_context_i] ? '0 : step_stored;
  assign read_value_o = zero_q[read_context_i] ? '0 : read_stored;

  always_ff @(posedge clk_i) begin
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (step_i && step_context_i == ContextBits'(c)) zero_q[c] <= 1'b0;
      if (clear_i && clear_context_i == ContextBits'(c)) zero_q[c] <= 1'b1;
    end
  end
endmodule
