// SPDX-License-Identifier: Apache-2.0
// From the end of a query to its packets: queries that are done wait for the sum of their powers; results leave by
// photon_gatherer_results in the order of the queries, photons by photon_gatherer_photons, and neither waits for the
// other. A query in an empty map is done when its list is empty; no leaf and no inner node were counted for it.
//
// Trees, lists and sums each have their part of the contexts: number n of N has the contexts c with c % N = n, as c / N.
//
// The slot store of a list is read by its sum, else by the photons. What belongs to the context is read when the sum
// takes it, since the context may start anew before the sum is out. A query takes count + 1 cycles of its sum, and
// where there are several up to Sums - 1 more; latency count + 6 from its turn to the end of its sum, where there are several
// or where they are many and far (ManyContexts) count + 7. Mirrors the end of search_gather in golden/unit/photon_gatherer.cpp.
module photon_gatherer_answers #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Lists = 1,
    parameter int unsigned Sums = 1,  // at most Lists
    parameter bit Wide = 1'b0,  // of several trees and lists
    parameter bit StartLater = 1'b0,  // start_i and search_i come a cycle after a query or flush starts
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
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
    input  logic                             clk_i,
    input  logic                             rst_i,
    // a query or a flush starts; a query does, in a context
    output logic                             slot_ready_o,
    output logic                             flush_ready_o,           // and a flush may
    input  logic                             start_i,
    input  logic                             search_i,
    input  logic [          ContextBits-1:0] search_context_i,
    /* verilator lint_off UNUSEDSIGNAL */  // position and normal are for the search
    input  photonloom_pkg::gather_query_t    query_i,
    /* verilator lint_on UNUSEDSIGNAL */
    // a query is done: in a tree, or else in an empty map
    input  logic [                Trees-1:0] tree_done_i,
    input  logic [Trees*TreeContextBits-1:0] tree_done_context_i,
    input  logic                             empty_done_i,
    input  logic [          ContextBits-1:0] empty_done_context_i,
    // what was found for a context, for each sum
    output logic [  Sums*SumContextBits-1:0] found_context_o,
    input  logic [       Sums*CountBits-1:0] found_count_i,
    input  logic [          Sums*R2Bits-1:0] found_r2_i,
    input  logic [   Sums*(IndexBits+1)-1:0] found_insertions_i,
    input  logic [        Sums*NodeBits-1:0] found_leaves_i,
    input  logic [        Sums*NodeBits-1:0] found_nodes_i,
    input  logic [                 Sums-1:0] found_faulty_i,
    // its photons, of each list: load, d2, index, a cycle after the address
    output logic [                Lists-1:0] store_read_o,
    output logic [Lists*ListContextBits-1:0] store_context_o,
    output logic [      Lists*PlaceBits-1:0] store_place_o,
    input  logic [      Lists*StoreBits-1:0] store_word_i,
    // a snapshot of their places in list order
    output logic                             snapshot_o,
    input  logic                             snapshot_taken_i,
    output logic [          ContextBits-1:0] snapshot_context_o,
    input  logic                             snapshot_done_i,
    input  logic [            CountBits-1:0] snapshot_count_i,
    input  logic [          K*PlaceBits-1:0] snapshot_places_i,
    // nothing more is read for the sum, for the photons
    output logic [                 Sums-1:0] sum_free_o,
    output logic [  Sums*SumContextBits-1:0] sum_free_context_o,
    output logic                             photons_free_o,
    output logic [          ContextBits-1:0] photons_free_context_o,
    // results
    output logic                             result_valid_o,
    input  logic                             result_ready_i,
    output photonloom_pkg::gather_result_t   result_o,
    // photons
    output logic                             photon_valid_o,
    input  logic                             photon_ready_i,
    output photonloom_pkg::gather_photon_t   photon_o
);
  localparam int unsigned QueueDepth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;
  // Of results. A slow query shares its gatherer with the others, so hundreds of them overtake it where many are in flight:
  // 8 a context, up to 512, which block RAM holds as well as fewer. Where LUTs hold 4 a context and not these, there are as many
  // as LUTs hold: block RAM is then short, and half of them cost few cycles. With parity each takes a flip-flop.
  localparam int unsigned LutWords = photonloom_pkg::LutRamWords;
  localparam int unsigned LutHolds = LutWords >= 512 ? 512 : LutWords >= 128 ? 128 : LutWords >= 64 ? 64 : 0;
  localparam int unsigned LutSlots = LutHolds >= 4 * QueueDepth ? LutHolds : 512;
  localparam int unsigned EnoughSlots = photonloom_pkg::Parity != 0 && LutSlots > 128 ? 128 : LutSlots;
  localparam int unsigned MostSlots = EnoughSlots > 2 * QueueDepth ? EnoughSlots : 2 * QueueDepth;
  localparam int unsigned Slots = 8 * QueueDepth < MostSlots ? 8 * QueueDepth : MostSlots;
  localparam int unsigned SlotBits = $clog2(Slots);
  localparam int unsigned Units = photonloom_pkg::Reciprocals != 0 ? photonloom_pkg::Reciprocals : Sums;  // reciprocals at once
  localparam bit ManyLists = Wide && Lists > 2;  // their slot stores are far apart
  // Memories with a word for each of more than 16 contexts are a choice of two cells of LUT RAM, or more, and spread over the part.
  localparam bit ManyContexts = photonloom_pkg::FarGatherers != 0 && Contexts > 16;
  localparam int unsigned RideBits = SlotBits + 1 + R2Bits + 2 * NodeBits + IndexBits + 1;
  localparam int unsigned FluxesBits = photonloom_pkg::Channels * photonloom_pkg::FluxBits;
  localparam int unsigned SumBits = CountBits + RideBits + FluxesBits;

  // ---- queries that are done ----
  logic [Trees-1:0] done;
  logic [Trees*TreeContextBits-1:0] done_context;
  logic [Sums-1:0] end_valid, end_ready, end_empty, next_valid, next_ready, next_empty;
  logic [Sums*SumContextBits-1:0] next_context;

  photon_gatherer_ends #(
      .Contexts(Contexts),
      .Trees(Trees),
      .Sums(Sums)
  ) ends (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .tree_done_i(tree_done_i),
      .tree_done_context_i(tree_done_context_i),
      .empty_done_i(empty_done_i),
      .empty_done_context_i(empty_done_context_i),
      .done_o(done),
      .done_context_o(done_context),
      .out_valid_o(next_valid),
      .out_ready_i(next_ready),
      .out_context_o(next_context),
      .out_empty_o(next_empty)
  );

  // Of a wide gatherer with fewer sums than trees it is late which tree's query is next, and far away what was found for one of
  // many contexts: it has a register before its sum.
  if ((Wide && Trees > Sums) || ManyContexts) begin : gen_end_register
    for (genvar s = 0; s < Sums; s++) begin : gen_sum_of
      logic valid_q, empty_q;
      logic [SumContextBits-1:0] context_q;
      assign next_ready[s] = !valid_q || end_ready[s];
      always_ff @(posedge clk_i) begin
        if (next_ready[s]) begin
          valid_q <= next_valid[s];
          empty_q <= next_empty[s];
          context_q <= next_context[SumContextBits*s+:SumContextBits];
        end
        if (rst_i) valid_q <= 1'b0;
      end
      assign end_valid[s] = valid_q;
      assign end_empty[s] = empty_q;
      assign found_context_o[SumContextBits*s+:SumContextBits] = context_q;
    end
  end else begin : gen_end
    assign end_valid = next_valid;
    assign next_ready = end_ready;
    assign found_context_o = next_context;
    assign end_empty = next_empty;
  end

  // ---- sums ----
  logic place_free;
  /* verilator lint_off UNUSEDSIGNAL */  // one list's photons take its word as it is
  logic [Lists*StoreBits-1:0] words;  // of the slot stores
  /* verilator lint_on UNUSEDSIGNAL */
  logic [SlotBits:0] start_slot, sum_slot;
  logic [Sums-1:0] sum_take, sum_read, sum_valid;
  logic [Sums*SlotBits-1:0] take_slot;
  logic [Sums*SumContextBits-1:0] sum_read_context;
  logic [Sums*PlaceBits-1:0] sum_read_place;
  logic [Sums*SumBits-1:0] sums;
  logic [CountBits-1:0] sum_count;
  logic [photonloom_pkg::Channels*photonloom_pkg::FluxBits-1:0] sum_flux;
  logic [R2Bits-1:0] sum_r2;
  logic [NodeBits-1:0] sum_leaves, sum_nodes;
  logic [IndexBits:0] sum_insertions;

  for (genvar s = 0; s < Sums; s++) begin : gen_sum
    localparam int unsigned Choices = Lists / Sums;
    logic ready;
    logic [SumContextBits-1:0] context_done;
    logic [SlotBits:0] done_slot;
    logic [PowerBits-1:0] power;

    assign end_ready[s] = ready && place_free;
    assign sum_take[s] = end_valid[s] && end_ready[s];
    assign context_done = found_context_o[SumContextBits*s+:SumContextBits];
    assign take_slot[SlotBits*s+:SlotBits] = done_slot[SlotBits-1:0];

    lut_ram #(
        .Width(SlotBits + 1),
        .Depth(SumContexts)
    ) result_slots (
        .clk_i(clk_i),
        .write_i(search_i && (32'(search_context_i) & (Sums - 1)) == s),
        .write_address_i(SumContextBits'(search_context_i >> $clog2(Sums))),
        .write_data_i(start_slot),
        .read_address_i(context_done),
        .read_data_o(done_slot)
    );

    // The power is in the slot store of the list that had the context when it was read: a cycle ago, of many lists two.
    if (Choices == 1) begin : gen_one_store
      assign power = words[StoreBits*s+StoreBits-1-:PowerBits];
    end else begin : gen_stores
      logic [SumContextBits-1:0] context_q, context_read;
      always_ff @(posedge clk_i) context_q <= sum_read_context[SumContextBits*s+:SumContextBits];
      always_comb begin
        power = '0;
        for (int unsigned i = 0; i < Choices; i++)
          if ((32'(context_read) & (Choices - 1)) == i)
            power = power | words[StoreBits*(Sums*i+s)+StoreBits-1-:PowerBits];
      end
      if (ManyLists) begin : gen_read_later
        logic [SumContextBits-1:0] context_2_q;
        always_ff @(posedge clk_i) context_2_q <= context_q;
        assign context_read = context_2_q;
      end else begin : gen_read
        assign context_read = context_q;
      end
    end

    photon_gatherer_sum #(
        .K(K),
        .Contexts(SumContexts),
        .Sums(Sums),
        .Sum(s),
        .Channels(photonloom_pkg::Channels),
        .MantissaBits(photonloom_pkg::MantissaBits),
        .ExponentBits(ExponentBits),
        .FluxBits(photonloom_pkg::FluxBits),
        .RideBits(RideBits),
        .ReadAhead(Wide && Sums == 1),
        .WordLater(ManyLists)
    ) sum (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(sum_take[s]),
        .in_ready_o(ready),
        .in_context_i(context_done),
        .in_count_i(found_count_i[CountBits*s+:CountBits]),
        .in_ride_i({
          done_slot,
          found_r2_i[R2Bits*s+:R2Bits],
          found_insertions_i[(IndexBits+1)*s+:IndexBits+1],
          end_empty[s] ? NodeBits'(0) : found_leaves_i[NodeBits*s+:NodeBits],
          end_empty[s] ? NodeBits'(0) : found_nodes_i[NodeBits*s+:NodeBits]
        }),
        .read_o(sum_read[s]),
        .read_context_o(sum_read_context[SumContextBits*s+:SumContextBits]),
        .read_place_o(sum_read_place[PlaceBits*s+:PlaceBits]),
        .read_power_i(power),
        .free_o(sum_free_o[s]),
        .free_context_o(sum_free_context_o[SumContextBits*s+:SumContextBits]),
        .out_valid_o(sum_valid[s]),
        .out_count_o(sums[SumBits*s+:CountBits]),
        .out_ride_o(sums[SumBits*s+CountBits+:RideBits]),
        .out_flux_o(sums[SumBits*s+CountBits+RideBits+:FluxesBits])
    );
  end

  // One sum a cycle is done. Of several, which one is known late: it comes to the results a cycle later.
  logic finish;
  logic [SumBits-1:0] sum_done, finished;
  always_comb begin
    sum_done = '0;
    for (int unsigned s = 0; s < Sums; s++)
      if (Sums == 1 || sum_valid[s]) sum_done = sum_done | sums[SumBits*s+:SumBits];
  end
  if (Sums > 1) begin : gen_finish_register
    logic finish_q;
    logic [SumBits-1:0] finished_q;
    always_ff @(posedge clk_i) begin
      finish_q <= sum_valid != '0 && !rst_i;
      finished_q <= sum_done;
    end
    assign finish = finish_q;
    assign finished = finished_q;
  end else begin : gen_finish
    assign finish = sum_valid[0];
    assign finished = sum_done;
  end
  assign {sum_flux, sum_slot, sum_r2, sum_insertions, sum_leaves, sum_nodes, sum_count} = finished;

  // ---- results ----
  photon_gatherer_results #(
      .Slots(Slots),
      .Sums(Sums),
      .Units(Units),
      .Wide(Wide),
      .BodyLater(ManyLists),
      .StartLater(StartLater)
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
      .take_slot_i(take_slot),
      .take_faulty_i(found_faulty_i),
      .finish_i(finish),
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
  logic [StoreBits-1:0] photon_word, read_word;
  logic [Lists-1:0] summed;  // the list's slot store is read by its sum

  photon_gatherer_photons #(
      .K(K),
      .Contexts(Contexts),
      .Trees(Trees),
      .Wide(Wide),
      .MoveLater((Wide && Lists > Sums) || ManyContexts),
      .WordLater(ManyLists),
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
      .read_ready_i(!summed[32'(photons_read_context)&(Lists-1)]),
      .read_context_o(photons_read_context),
      .read_place_o(photons_read_place),
      .read_data_i(read_word),
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

  // ---- the slot stores ----
  // Where they are many, a register before what chooses among them.
  if (ManyLists) begin : gen_words_register
    logic [Lists*StoreBits-1:0] words_q;
    always_ff @(posedge clk_i) words_q <= store_word_i;
    assign words = words_q;
  end else begin : gen_words_at_once
    assign words = store_word_i;
  end

  for (genvar l = 0; l < Lists; l++) begin : gen_store
    localparam int unsigned Sum = l % Sums;
    logic [SumContextBits-1:0] context_summed;
    assign context_summed = sum_read_context[SumContextBits*Sum+:SumContextBits];
    assign summed[l] = sum_read[Sum] && (32'(context_summed) & (Lists / Sums - 1)) == l / Sums;
    assign store_read_o[l] = summed[l] || (photons_read && (32'(photons_read_context) & (Lists - 1)) == l);
    assign {store_context_o[ListContextBits*l+:ListContextBits], store_place_o[PlaceBits*l+:PlaceBits]} = summed[l] ?
        {ListContextBits'(context_summed >> $clog2(Lists / Sums)), sum_read_place[PlaceBits*Sum+:PlaceBits]} :
        {ListContextBits'(photons_read_context >> $clog2(Lists)), photons_read_place};
  end
  if (Lists == 1) begin : gen_one_word
    assign read_word = store_word_i;
  end else begin : gen_words
    logic [ContextBits-1:0] context_q, word_context;
    always_ff @(posedge clk_i) context_q <= photons_read_context;
    if (ManyLists) begin : gen_later
      logic [ContextBits-1:0] context_2_q;
      always_ff @(posedge clk_i) context_2_q <= context_q;
      assign word_context = context_2_q;
    end else begin : gen_at_once
      assign word_context = context_q;
    end
    always_comb begin
      read_word = '0;
      for (int unsigned l = 0; l < Lists; l++)
        if ((32'(word_context) & (Lists - 1)) == l) read_word = read_word | words[StoreBits*l+:StoreBits];
    end
  end
endmodule
