// SPDX-License-Identifier: Apache-2.0
// Photons and sample requests in, directions with their probability out. A stream of tables: header, photons, requests.
// Photons that come before a header, after a table's first request or beyond the K-th are ignored, so are requests
// before the first header. Golden: golden/unit/cdf_sampler.cpp; definition: docs/cdf_sampler.md.
//
// Two tables alternate: while one is sampled, a sample a cycle, the next one's photons add up and its prefix sums are
// made. A table takes max(photons, T) + 4^CellBits + 12 + Delay cycles from its header, T = ceil((2^(CellBits-1) + 1) / 2)
// (one less where there are no photons, 0 without the cosine's total) and Delay as in cdf_sampler_weights; a sample takes 4 * CellBits + 6 cycles from its
// waiting request, and comes in order. Requests wait in a FIFO of RequestDepth
// while their table is built; where a table has more of them, the next one begins when they have found place. No packet
// is processed for 4^CellBits cycles after reset.
module cdf_sampler #(
    parameter int unsigned CellBits = photonloom_pkg::CellBits,
    parameter int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    parameter int unsigned NormalBits = photonloom_pkg::NormalBits,
    parameter int unsigned Channels = photonloom_pkg::Channels,
    parameter int unsigned MantissaBits = photonloom_pkg::MantissaBits,
    parameter int unsigned ExponentBits = photonloom_pkg::ExponentBits,
    parameter int unsigned K = photonloom_pkg::K,
    parameter int unsigned ProbabilityBits = photonloom_pkg::ProbabilityBits,
    parameter int unsigned UBits = photonloom_pkg::UBits,
    parameter int unsigned VBits = photonloom_pkg::VBits,
    parameter int unsigned Combine = photonloom_pkg::Combine,  // 0 sum, 1 product, 2 weighted, 3 photons, 4 cosine
    parameter int unsigned Levels = photonloom_pkg::Levels,
    parameter int unsigned CosineSamples = photonloom_pkg::CosineSamples,
    parameter int unsigned RequestDepth = 64  // a power of two
) (
    input  logic clk_i,  // clock
    input  logic rst_i,  // reset, synchronous
    input  logic in_valid_i,  // offered
    output logic in_ready_o,  // taken when offered
    input  photonloom_pkg::sampler_input_t in_i,  // the packet
    output logic out_valid_o,  // offered
    input  logic out_ready_i,  // taken when offered
    output photonloom_pkg::sample_t out_o,  // the packet
    output logic [31:0] count_tables_o,  // headers taken in
    output logic [31:0] count_photons_o,  // photons that counted
    output logic [31:0] count_samples_o,  // samples given out
    output logic [31:0] count_cycles_busy_o,  // cycles in which a table was built or a sample was under way
    output logic [31:0] count_cycles_building_o  // cycles from header to finished table
);
  localparam int unsigned IndexBits = 2 * CellBits;
  localparam int unsigned AxisBits = NormalBits + 2;
  localparam int unsigned PowerBits = MantissaBits + $clog2(Channels) + (1 << ExponentBits) - 1;
  localparam int unsigned PowerTotalBits = PowerBits + $clog2(K);
  localparam int unsigned SpreadBits = PowerTotalBits + 2 * (Levels - 1) + $clog2(Levels);
  localparam int unsigned CosineTotalBits = 3 * CellBits + NormalBits + 8;
  localparam int unsigned TotalBits = ProbabilityBits + IndexBits;
  localparam int unsigned PixelBits = photonloom_pkg::PixelBits;
  localparam int unsigned SampleBits = photonloom_pkg::SampleBits;
  localparam int unsigned CountBits = $clog2(K + 1);

  localparam logic [1:0] Header = 2'd0;
  localparam logic [1:0] Photon = 2'd1;
  localparam logic [1:0] Request = 2'd2;

  photonloom_pkg::sampler_input_t packet;
  logic valid, ready;
  skid_buffer #(
      .Width(photonloom_pkg::SamplerInputPacketBits)
  ) incoming (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .out_valid_o(valid),
      .out_ready_i(ready),
      .out_o(packet)
  );

  // The table being built.
  typedef enum logic [1:0] {
    Idle,  // no table takes photons: none yet, or the last one is finished
    Add,   // photons add up
    Walk,  // cells are read
    Drain  // the last weights are on their way
  } state_t;
  state_t state_q;
  logic fresh_q;  // a header may come: the state is Idle, or Add and no photon has come
  logic open_q;  // a header has come
  logic table_q;  // which of the two tables
  logic [PixelBits-1:0] header_pixel_q;
  logic [SampleBits-1:0] header_sample_q;
  logic [3*AxisBits-1:0] normal, normal_q;
  logic [CountBits-1:0] photons_q;
  logic [IndexBits-1:0] walk_cell_q;
  logic begin_table, end_photons, add_photon, power_ready, cosine_last, cosine_next_last, last_weight;

  // Both tables.
  logic [1:0] finished_q;
  logic [2*PixelBits-1:0] pixels_q;
  logic [2*SampleBits-1:0] samples_q;
  logic [2*TotalBits-1:0] totals_q;
  logic [1:0] owing;  // samples are still owed from this table

  // What becomes of the packet.
  logic request_push, request_ready, old_samples_out;
  assign old_samples_out = !owing[table_q];
  assign begin_table = valid && packet.kind == Header && power_ready && fresh_q;
  assign add_photon = valid && packet.kind == Photon && state_q == Add && photons_q != CountBits'(K);
  // The first request, or a header with no request before it, ends the photons. Where there are none no power is multiplied by the
  // cosine's total, of which only the leading zeros are wanted, and later.
  assign end_photons = valid && state_q == Add && old_samples_out && (photons_q == '0 ? cosine_next_last : cosine_last) &&
      (packet.kind == Request || (packet.kind == Header && photons_q != '0));
  assign request_push = valid && packet.kind == Request && open_q && state_q != Add;
  always_comb begin
    unique case (packet.kind)
      Header:  ready = power_ready && fresh_q;
      Request: ready = power_ready && (!open_q || (state_q != Add && request_ready));
      default: ready = power_ready;
    endcase
  end

  oct_decode #(
      .Bits(NormalBits)
  ) normal_of_header (
      .code_i(packet.normal),
      .direction_o(normal)
  );

  always_ff @(posedge clk_i) begin
    if (begin_table) begin
      state_q <= Add;
      fresh_q <= 1'b1;
      open_q <= 1'b1;
      table_q <= !table_q;
      header_pixel_q <= packet.pixel;
      header_sample_q <= packet.sample;
      normal_q <= normal;
      photons_q <= '0;
    end
    if (add_photon) photons_q <= photons_q + 1'b1;
    if (add_photon || end_photons) fresh_q <= 1'b0;
    if (end_photons) begin
      state_q <= Walk;
      walk_cell_q <= '0;
    end
    if (state_q == Walk) begin
      walk_cell_q <= walk_cell_q + 1'b1;
      if (walk_cell_q == '1) state_q <= Drain;
    end
    if (last_weight) begin
      state_q <= Idle;
      fresh_q <= 1'b1;
    end
    if (rst_i) begin
      state_q <= Idle;
      fresh_q <= 1'b1;
      open_q  <= 1'b0;
      table_q <= 1'b0;
    end
  end

  // Photons: their power in all channels, in their cell.
  logic [MantissaBits+$clog2(Channels)-1:0] mantissas;
  logic [IndexBits-1:0] photon_cell, add_cell_q, power_cell;
  // The lowest bits of the exponent shift at once, the others a cycle later.
  localparam int unsigned EarlyBits = ExponentBits > 2 ? 2 : 1;
  localparam int unsigned FactorBits = MantissaBits + $clog2(Channels) + (1 << EarlyBits) - 1;
  logic [FactorBits-1:0] add_factor_q;
  logic [ExponentBits-1:0] add_shift_q;
  logic add_q, power_read, begin_q;
  logic [SpreadBits-1:0] spread;
  logic [PowerTotalBits-1:0] power_total;

  always_comb begin
    mantissas = '0;
    for (int unsigned c = 0; c < Channels; c++) begin
      mantissas = mantissas + ($clog2(Channels) + MantissaBits)'(packet.mantissa[MantissaBits*c+:MantissaBits]);
    end
  end
  assign photon_cell = {packet.direction[2*DirectionBits-1-:CellBits], packet.direction[DirectionBits-1-:CellBits]};
  if (DirectionBits > CellBits) begin : gen_finer
    logic unused;
    assign unused = &{1'b0, packet.direction[DirectionBits+:DirectionBits-CellBits],
        packet.direction[0+:DirectionBits-CellBits]};
  end

  always_ff @(posedge clk_i) begin
    add_q <= add_photon;
    add_cell_q <= photon_cell;
    add_factor_q <= FactorBits'(mantissas) << packet.exponent[EarlyBits-1:0];
    add_shift_q <= (packet.exponent >> EarlyBits) << EarlyBits;
    begin_q <= begin_table;
    if (rst_i) add_q <= 1'b0;
  end

  if (Combine == 4) begin : gen_no_powers
    assign power_ready = 1'b1;
    assign spread = '0;
    assign power_total = '0;
    logic unused_power;
    assign unused_power = &{1'b0, begin_q, add_q, add_cell_q, add_factor_q, add_shift_q, power_read, power_cell};
  end else begin : gen_powers
    cdf_sampler_levels #(
        .CellBits(CellBits),
        .Levels(Levels),
        .PowerBits(PowerBits),
        .FactorBits(FactorBits),
        .ShiftBits(ExponentBits),
        .TotalBits(PowerTotalBits)
    ) powers (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .ready_o(power_ready),
        .start_i(begin_q),
        .add_i(add_q),
        .add_cell_i(add_cell_q),
        .add_factor_i(add_factor_q),
        .add_shift_i(add_shift_q),
        .read_i(power_read),
        .read_cell_i(power_cell),
        .spread_o(spread),
        .total_o(power_total)
    );
  end

  // The BRDF's total, beside the photons.
  logic [CosineTotalBits-1:0] cosine_total;

  if (Combine != 1) begin : gen_cosine_total
    cdf_sampler_cosine_total #(
        .CellBits(CellBits),
        .NormalBits(NormalBits),
        .TotalBits(CosineTotalBits)
    ) cosine_sum (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .start_i(begin_table),
        .normal_i(packet.normal),
        .last_o(cosine_last),
        .next_last_o(cosine_next_last),
        .total_o(cosine_total)
    );
  end else begin : gen_no_cosine_total
    assign cosine_last = 1'b1;
    assign cosine_next_last = 1'b1;
    assign cosine_total = '0;
  end

  // Weights, and their prefix sums.
  logic weight_valid;
  logic [IndexBits-1:0] weight_cell;
  logic [ProbabilityBits-1:0] weight;
  logic [TotalBits-1:0] prefix_q, prefix_next;
  cdf_sampler_weights #(
      .CellBits(CellBits),
      .NormalBits(NormalBits),
      .PowerBits(PowerTotalBits),
      .CosineBits(CosineTotalBits),
      .ProbabilityBits(ProbabilityBits),
      .Combine(Combine),
      .Levels(Levels),
      .CosineSamples(CosineSamples),
      .CountBits(CountBits)
  ) weights (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .walk_i(state_q == Walk),
      .cell_i(walk_cell_q),
      .normal_i(normal_q),
      .power_read_o(power_read),
      .power_cell_o(power_cell),
      .spread_i(spread),
      .power_total_i(power_total),
      .photons_i(photons_q),
      .cosine_total_i(cosine_total),
      .weight_valid_o(weight_valid),
      .weight_cell_o(weight_cell),
      .weight_o(weight)
  );
  assign prefix_next = prefix_q + TotalBits'(weight);
  assign last_weight = weight_valid && weight_cell == '1;

  always_ff @(posedge clk_i) begin
    if (end_photons) begin
      prefix_q <= '0;
      finished_q[table_q] <= 1'b0;
      if (table_q) pixels_q[PixelBits+:PixelBits] <= header_pixel_q;
      else pixels_q[0+:PixelBits] <= header_pixel_q;
      if (table_q) samples_q[SampleBits+:SampleBits] <= header_sample_q;
      else samples_q[0+:SampleBits] <= header_sample_q;
    end
    if (weight_valid) prefix_q <= prefix_next;
    if (last_weight) begin
      finished_q[table_q] <= 1'b1;
      if (table_q) totals_q[TotalBits+:TotalBits] <= prefix_next;
      else totals_q[0+:TotalBits] <= prefix_next;
    end
    if (rst_i) finished_q <= '0;
  end

  cdf_sampler_draw #(
      .CellBits(CellBits),
      .ProbabilityBits(ProbabilityBits),
      .UBits(UBits),
      .VBits(VBits),
      .RequestDepth(RequestDepth)
  ) draw (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(request_push && power_ready),
      .in_ready_o(request_ready),
      .in_table_i(table_q),
      .in_u_i(packet.u),
      .in_tag_i(packet.tag),
      .in_v_i(packet.v),
      .write_i(weight_valid),
      .write_table_i(table_q),
      .write_cell_i(weight_cell),
      .write_prefix_i(prefix_q),
      .finished_i(finished_q),
      .totals_i(totals_q),
      .pixels_i(pixels_q),
      .samples_i(samples_q),
      .owing_o(owing),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o(out_o)
  );

  counter tables (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(begin_table),
      .count_o(count_tables_o)
  );
  counter photons (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(add_photon),
      .count_o(count_photons_o)
  );
  counter samples (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(out_valid_o && out_ready_i),
      .count_o(count_samples_o)
  );
  counter cycles_busy (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(state_q != Idle || owing != '0 || out_valid_o),
      .count_o(count_cycles_busy_o)
  );
  counter cycles_building (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(state_q != Idle),
      .count_o(count_cycles_building_o)
  );

  // A table is rewritten only when nothing is owed.
`ifndef SYNTHESIS
  always_ff @(posedge clk_i) begin
    if (!rst_i) assert (!weight_valid || finished_q[table_q] == 1'b0);
  end
`endif
endmodule
