// SPDX-License-Identifier: Apache-2.0
// Exact flux of finished queries: reads the n loads of a context from the slot store, one a cycle, decodes
// mantissa * 2^exponent and adds. Queries follow each other without a gap but the cycle in which the next is taken.
// Latency n + 5. The sum appears with its context while the context's other state can still be read.
module photon_gatherer_sum #(
    parameter int unsigned K = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned Channels = 3,
    parameter int unsigned MantissaBits = 9,
    parameter int unsigned ExponentBits = 5,
    parameter int unsigned FluxBits = 44,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1),
    localparam int unsigned PowerBits = Channels * MantissaBits + ExponentBits
) (
    input  logic                         clk_i,
    input  logic                         rst_i,
    // finished queries
    input  logic                         in_valid_i,
    output logic                         in_ready_o,
    input  logic [      ContextBits-1:0] in_context_i,
    input  logic [        CountBits-1:0] in_count_i,
    // slot store: data a cycle after the address
    output logic                         read_o,
    output logic [      ContextBits-1:0] read_context_o,
    output logic [        PlaceBits-1:0] read_place_o,
    input  logic [        PowerBits-1:0] read_power_i,    // exponent, mantissas
    // sums
    output logic                         out_valid_o,
    output logic [      ContextBits-1:0] out_context_o,
    output logic [        CountBits-1:0] out_count_o,
    output logic [Channels*FluxBits-1:0] out_flux_o
);
  // ---- addresses ----
  logic active_q, empty_q, last;
  logic [ContextBits-1:0] context_q;
  logic [CountBits-1:0] left_q, count_q;
  logic [PlaceBits-1:0] place_q;

  assign last = empty_q || left_q == CountBits'(1);
  assign in_ready_o = !active_q || last;
  assign read_o = active_q && !empty_q;
  assign read_context_o = context_q;
  assign read_place_o = place_q;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      active_q <= in_valid_i;
      context_q <= in_context_i;
      left_q <= in_count_i;
      count_q <= in_count_i;
      empty_q <= in_count_i == '0;
      place_q <= '0;
    end else begin
      left_q <= left_q - 1'b1;
      place_q <= place_q + 1'b1;
    end
    if (rst_i) active_q <= 1'b0;
  end

  // ---- data | register | shift | add ----
  localparam int unsigned Stages = 4;
  logic [Stages-1:0] valid_q, last_q;
  logic [2:0] first_q;
  logic [1:0] empty_s_q;
  logic [ContextBits-1:0] context_s_q[0:Stages-1];
  logic [CountBits-1:0] count_s_q[0:Stages-1];
  logic [PowerBits-1:0] power_q;
  logic [Channels*FluxBits-1:0] value_q, flux_q;

  always_ff @(posedge clk_i) begin
    valid_q <= {valid_q[Stages-2:0], active_q};
    last_q <= {last_q[Stages-2:0], last};
    first_q <= {first_q[1:0], place_q == '0};
    empty_s_q <= {empty_s_q[0], empty_q};
    context_s_q[0] <= context_q;
    count_s_q[0] <= count_q;
    for (int unsigned i = 1; i < Stages; i++) begin
      context_s_q[i] <= context_s_q[i-1];
      count_s_q[i] <= count_s_q[i-1];
    end
    power_q <= read_power_i;
    for (int unsigned c = 0; c < Channels; c++) begin
      value_q[FluxBits*c+:FluxBits] <= empty_s_q[1] ? '0 :
          FluxBits'(power_q[MantissaBits*c+:MantissaBits]) << power_q[PowerBits-1-:ExponentBits];
      flux_q[FluxBits*c+:FluxBits] <= value_q[FluxBits*c+:FluxBits] + (first_q[2] ? '0 : flux_q[FluxBits*c+:FluxBits]);
    end
    if (rst_i) valid_q <= '0;
  end

  assign out_valid_o = valid_q[Stages-1] && last_q[Stages-1];
  assign out_context_o = context_s_q[Stages-1];
  assign out_count_o = count_s_q[Stages-1];
  assign out_flux_o = flux_q;
endmodule
