// SPDX-License-Identifier: Apache-2.0
// Exact flux of finished queries: reads the n loads of a context from the slot store, one a cycle, decodes
// mantissa * 2^exponent (a multiplier by a power of two, then one step of 16) and adds. Queries follow each other
// without a gap but the cycle in which the next is taken, in which the sum is cleared too. Latency n + 6, of none 7. What
// else is to go with the sum rides along, so the query's context is free when its last load is read.
//
// Of Sums such modules each ends its queries in cycles of its own, every Sums-th: it waits with the last load, or with the
// end of a query that has none, until its turn. So one sum a cycle is done, and none waits for another.
module photon_gatherer_sum #(
    parameter int unsigned K = 16,
    parameter int unsigned Contexts = 16,  // of this sum
    parameter int unsigned Sums = 1,
    parameter int unsigned Sum = 0,
    parameter int unsigned Channels = 3,
    parameter int unsigned MantissaBits = 9,
    parameter int unsigned ExponentBits = 5,
    parameter int unsigned FluxBits = 44,
    parameter int unsigned RideBits = 18,  // what else goes with a query
    parameter bit ReadAhead = 1'b0,  // of one sum: whether it reads is a register
    parameter bit WordLater = 1'b0,  // a word of the slot store comes a cycle later, from a register
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
    input  logic [         RideBits-1:0] in_ride_i,
    // slot store: data a cycle after the address, with WordLater two
    output logic                         read_o,
    output logic [      ContextBits-1:0] read_context_o,
    output logic [        PlaceBits-1:0] read_place_o,
    input  logic [        PowerBits-1:0] read_power_i,    // exponent, mantissas
    // nothing more to be read
    output logic                         free_o,
    output logic [      ContextBits-1:0] free_context_o,
    // sums
    output logic                         out_valid_o,
    output logic [        CountBits-1:0] out_count_o,
    output logic [         RideBits-1:0] out_ride_o,
    output logic [Channels*FluxBits-1:0] out_flux_o
);
  localparam int unsigned StepBits = ExponentBits < 4 ? ExponentBits : 4;  // of the exponent, for the multiplier
  localparam int unsigned FactorBits = 1 << StepBits;
  localparam int unsigned ProductBits = MantissaBits + FactorBits;

  // ---- addresses ----
  logic active_q, empty_q, last, turn;
  logic [ContextBits-1:0] context_q;
  logic [CountBits-1:0] left_q, count_q;
  logic [PlaceBits-1:0] place_q;
  logic [RideBits-1:0] ride_q;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic reads_q;  // where ReadAhead
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  if (Sums == 1) begin : gen_always
    assign turn = 1'b1;
  end else begin : gen_turn
    localparam int unsigned TurnBits = $clog2(Sums);
    logic [TurnBits-1:0] turn_q;
    always_ff @(posedge clk_i) turn_q <= rst_i ? '0 : turn_q + 1'b1;
    assign turn = turn_q == TurnBits'(Sum);
  end

  assign last = (empty_q || left_q == CountBits'(1)) && turn;
  assign in_ready_o = !active_q;
  assign read_o = ReadAhead ? reads_q : active_q && !empty_q && (turn || left_q != CountBits'(1));
  if (ReadAhead) begin : gen_read_ahead
    always_ff @(posedge clk_i) reads_q <= !rst_i && (in_ready_o ? in_valid_i && in_count_i != '0 : reads_q && !last);
  end
  assign read_context_o = context_q;
  assign read_place_o = place_q;
  assign free_o = active_q && last;
  assign free_context_o = context_q;

  always_ff @(posedge clk_i) begin
    if (in_ready_o) begin
      active_q <= in_valid_i;
      context_q <= in_context_i;
      left_q <= in_count_i;
      count_q <= in_count_i;
      ride_q <= in_ride_i;
      empty_q <= in_count_i == '0;
      place_q <= '0;
    end else begin
      if (last) active_q <= 1'b0;
      if (Sums == 1 || read_o) begin
        left_q <= left_q - 1'b1;
        place_q <= place_q + 1'b1;
      end
    end
    if (rst_i) active_q <= 1'b0;
  end

  // ---- data | register | decode | multiply | step of 16 | add ----
  localparam int unsigned Stages = 6;
  logic [Stages-1:0] active_s_q, read_s_q, last_q;
  logic [CountBits-1:0] count_s_q[0:Stages-1];
  logic [RideBits-1:0] ride_s_q[0:Stages-1];
  logic [Channels*MantissaBits-1:0] mantissas_q;
  logic [FactorBits-1:0] factor_q;
  logic step_q, step_2_q;
  logic [Channels*ProductBits-1:0] product_q;
  logic [Channels*FluxBits-1:0] value_q, flux_q;
  logic [PowerBits-1:0] power_q;  // nothing between block RAM and its register
  logic [PowerBits-1:0] power;
  logic [ExponentBits-1:0] exponent;

  assign power = WordLater ? read_power_i : power_q;
  assign exponent = power[PowerBits-1-:ExponentBits];

  always_ff @(posedge clk_i) begin
    active_s_q <= {active_s_q[Stages-2:0], active_q};
    read_s_q <= {read_s_q[Stages-2:0], read_o};
    last_q <= {last_q[Stages-2:0], last};
    count_s_q[0] <= count_q;
    ride_s_q[0] <= ride_q;
    for (int unsigned i = 1; i < Stages; i++) begin
      count_s_q[i] <= count_s_q[i-1];
      ride_s_q[i] <= ride_s_q[i-1];
    end
    power_q <= read_power_i;
    mantissas_q <= power[Channels*MantissaBits-1:0];
    for (int unsigned i = 0; i < FactorBits; i++) factor_q[i] <= exponent[StepBits-1:0] == StepBits'(i);
    step_q <= ExponentBits > 4 && exponent[ExponentBits-1];
    step_2_q <= step_q;
    for (int unsigned c = 0; c < Channels; c++) begin
      product_q[ProductBits*c+:ProductBits] <= mantissas_q[MantissaBits*c+:MantissaBits] * factor_q;
      value_q[FluxBits*c+:FluxBits] <=
          step_2_q ? FluxBits'(product_q[ProductBits*c+:ProductBits]) << 16 :
          FluxBits'(product_q[ProductBits*c+:ProductBits]);
      if (Sums == 1 || read_s_q[Stages-2])
        flux_q[FluxBits*c+:FluxBits] <= flux_q[FluxBits*c+:FluxBits] + value_q[FluxBits*c+:FluxBits];
    end
    // Cleared between queries; value_q of a query without photons is not added. A query waits with its sum for its turn.
    if (Sums == 1 ? !read_s_q[Stages-2] : !active_s_q[Stages-2]) flux_q <= '0;
    if (rst_i) active_s_q <= '0;
  end

  assign out_valid_o = active_s_q[Stages-1] && last_q[Stages-1];
  assign out_count_o = count_s_q[Stages-1];
  assign out_ride_o = ride_s_q[Stages-1];
  assign out_flux_o = flux_q;
endmodule
