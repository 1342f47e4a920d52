// SPDX-License-Identifier: Apache-2.0
// From the end of a query to its packets: queries that are done wait for the sum of their powers; results leave by
// photon_gatherer_results in the order of the queries, photons by photon_gatherer_photons, and neither waits for the
// other. A query in an empty map is done when its list is empty; no leaf and no inner node were counted for it.
//
// The slot store is read by the sum, else by the photons. What belongs to the context is read when the sum takes it,
// since the context may start anew before the sum is out. A query takes count + 1 cycles of the sum, latency
// count + 8 from its turn to the end of its sum. Mirrors the end of search_gather in golden/unit/photon_gatherer.cpp.
module photon_gatherer_answers #(
    parameter int unsigned Contexts = 16,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned K = photonloom_pkg::K,
    localparam int unsigned CountBits = photonloom_pkg::CountBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned NodeBits = photonloom_pkg::LineBits + 1,
    localparam int unsigned IndexBits = photonloom_pkg::IndexBits,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned MantissasBits = photonloom_pkg::Channels * photonloom_pkg::MantissaBits,
    localparam int unsigned ExponentBits = photonloom_pkg::ExponentBits,
    localparam int unsigned PowerBits = MantissasBits + ExponentBits,
    localparam int unsigned StoreBits = 2 * DirectionBits + PowerBits + R2Bits + IndexBits
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    // a query or a flush starts; a query does, in a context
    output logic                           slot_ready_o,
    output logic                           flush_ready_o,         // and a flush may
    input  logic                           start_i,
    input  logic                           search_i,
    input  logic [        ContextBits-1:0] search_context_i,
    /* verilator lint_off UNUSEDSIGNAL */  // position and normal are for the search
    input  photonloom_pkg::gather_query_t  query_i,
    /* verilator lint_on UNUSEDSIGNAL */
    // a query is done: in the tree, or else in an empty map
    input  logic                           tree_done_i,
    input  logic [        ContextBits-1:0] tree_done_context_i,
    input  logic                           empty_done_i,
    input  logic [        ContextBits-1:0] empty_done_context_i,
    // what was found for a context
    output logic [        ContextBits-1:0] found_context_o,
    input  logic [          CountBits-1:0] found_count_i,
    input  logic [             R2Bits-1:0] found_r2_i,
    input  logic [            IndexBits:0] found_insertions_i,
    input  logic [           NodeBits-1:0] found_leaves_i,
    input  logic [           NodeBits-1:0] found_nodes_i,
    // its photons: load, d2, index, a cycle after the address
    output logic                           store_read_o,
    output logic [        ContextBits-1:0] store_context_o,
    output logic [          PlaceBits-1:0] store_place_o,
    input  logic [          StoreBits-1:0] store_word_i,
    // a snapshot of their places in list order
    output logic                           snapshot_o,
    input  logic                           snapshot_taken_i,
    output logic [        ContextBits-1:0] snapshot_context_o,
    input  logic                           snapshot_done_i,
    input  logic [          CountBits-1:0] snapshot_count_i,
    input  logic [        K*PlaceBits-1:0] snapshot_places_i,
    // nothing more is read for the sum, for the photons
    output logic                           sum_free_o,
    output logic [        ContextBits-1:0] sum_free_context_o,
    output logic                           photons_free_o,
    output logic [        ContextBits-1:0] photons_free_context_o,
    // results
    output logic                           result_valid_o,
    input  logic                           result_ready_i,
    output photonloom_pkg::gather_result_t result_o,
    // photons
    output logic                           photon_valid_o,
    input  logic                           photon_ready_i,
    output photonloom_pkg::gather_photon_t photon_o
);
  localparam int unsigned QueueDepth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;
  // Of results; 64 of them are enough, and as many as LUTs hold well.
  localparam int unsigned Slots = QueueDepth > 16 ? 2 * QueueDepth : 4 * QueueDepth;
  localparam int unsigned SlotBits = $clog2(Slots);
  localparam int unsigned RideBits = SlotBits + 1 + R2Bits + 2 * NodeBits + IndexBits + 1;

  // ---- queries that are done ----
  logic done, done_valid, done_empty, sum_ready, place_free, sum_take;
  logic [ContextBits-1:0] done_context;
  /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
  logic done_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  assign done = tree_done_i || empty_done_i;
  assign done_context = tree_done_i ? tree_done_context_i : empty_done_context_i;

  fifo #(
      .Width(ContextBits + 1),
      .Depth(QueueDepth)
  ) done_queue (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(done),
      .in_ready_o(done_ready),
      .in_i({done_context, !tree_done_i}),
      .out_valid_o(done_valid),
      .out_ready_i(sum_ready && place_free),
      .out_o({found_context_o, done_empty})
  );
  assign sum_take = done_valid && sum_ready && place_free;

  // ---- sums ----
  logic [SlotBits:0] start_slot, done_slot, sum_slot;
  logic sum_read, sum_valid;
  logic [ContextBits-1:0] sum_read_context;
  logic [PlaceBits-1:0] sum_read_place;
  logic [CountBits-1:0] sum_count;
  logic [photonloom_pkg::Channels*photonloom_pkg::FluxBits-1:0] sum_flux;
  logic [R2Bits-1:0] sum_r2;
  logic [NodeBits-1:0] sum_leaves, sum_nodes;
  logic [IndexBits:0] sum_insertions;

  lut_ram #(
      .Width(SlotBits + 1),
      .Depth(Contexts)
  ) result_slots (
      .clk_i(clk_i),
      .write_i(search_i),
      .write_address_i(search_context_i),
      .write_data_i(start_slot),
      .read_address_i(found_context_o),
      .read_data_o(done_slot)
  );

  photon_gatherer_sum #(
      .K(K),
      .Contexts(Contexts),
      .Channels(photonloom_pkg::Channels),
      .MantissaBits(photonloom_pkg::MantissaBits),
      .ExponentBits(ExponentBits),
      .FluxBits(photonloom_pkg::FluxBits),
      .RideBits(RideBits)
  ) sum (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(sum_take),
      .in_ready_o(sum_ready),
      .in_context_i(found_context_o),
      .in_count_i(found_count_i),
      .in_ride_i({
        done_slot,
        found_r2_i,
        found_insertions_i,
        done_empty ? NodeBits'(0) : found_leaves_i,
        done_empty ? NodeBits'(0) : found_nodes_i
      }),
      .read_o(sum_read),
      .read_context_o(sum_read_context),
      .read_place_o(sum_read_place),
      .read_power_i(store_word_i[StoreBits-1-:PowerBits]),
      .free_o(sum_free_o),
      .free_context_o(sum_free_context_o),
      .out_valid_o(sum_valid),
      .out_count_o(sum_count),
      .out_ride_o({sum_slot, sum_r2, sum_insertions, sum_leaves, sum_nodes}),
      .out_flux_o(sum_flux)
  );

  // ---- results ----
  photon_gatherer_results #(
      .Slots(Slots)
  ) results (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_ready_o(slot_ready_o),
      .flush_ready_o(flush_ready_o),
      .start_i(start_i),
      .start_flush_i(query_i.flush),
      .start_map_i(query_i.map),
      .start_tag_i(query_i.tag),
      .start_sample_i(query_i.sample),
      .start_pixel_i(query_i.pixel),
      .start_slot_o(start_slot),
      .take_ready_o(place_free),
      .take_i(sum_take),
      .finish_i(sum_valid),
      .finish_slot_i(sum_slot),
      .finish_count_i(sum_count),
      .finish_r2_i(sum_r2),
      .finish_flux_i(sum_flux),
      .finish_nodes_i(sum_nodes),
      .finish_leaves_i(sum_leaves),
      .finish_insertions_i(sum_insertions),
      .result_valid_o(result_valid_o),
      .result_ready_i(result_ready_i),
      .result_o(result_o)
  );

  // ---- photons ----
  logic photons_read, photon_last;
  logic [ContextBits-1:0] photons_read_context;
  logic [PlaceBits-1:0] photons_read_place;
  logic [StoreBits-1:0] photon_word;

  photon_gatherer_photons #(
      .K(K),
      .Contexts(Contexts),
      .StoreBits(StoreBits)
  ) photons (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_i(search_i && query_i.want_photons),
      .start_context_i(search_context_i),
      .done_i(done),
      .done_context_i(done_context),
      .snapshot_valid_o(snapshot_o),
      .snapshot_ready_i(snapshot_taken_i),
      .snapshot_context_o(snapshot_context_o),
      .snapshot_i(snapshot_done_i),
      .snapshot_count_i(snapshot_count_i),
      .snapshot_places_i(snapshot_places_i),
      .read_valid_o(photons_read),
      .read_ready_i(!sum_read),
      .read_context_o(photons_read_context),
      .read_place_o(photons_read_place),
      .read_data_i(store_word_i),
      .free_o(photons_free_o),
      .free_context_o(photons_free_context_o),
      .out_valid_o(photon_valid_o),
      .out_ready_i(photon_ready_i),
      .out_data_o(photon_word),
      .out_last_o(photon_last)
  );

  always_comb begin
    photon_o.index = photon_word[0+:IndexBits];
    photon_o.d2 = photon_word[IndexBits+:R2Bits];
    photon_o.direction = photon_word[IndexBits+R2Bits+:2*DirectionBits];
    photon_o.mantissa = photon_word[IndexBits+R2Bits+2*DirectionBits+:MantissasBits];
    photon_o.exponent = photon_word[StoreBits-1-:ExponentBits];
    photon_o.last = photon_last;
  end

  assign store_read_o = sum_read || photons_read;
  assign {store_context_o, store_place_o} =
      sum_read ? {sum_read_context, sum_read_place} : {photons_read_context, photons_read_place};
endmodule
