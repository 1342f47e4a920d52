// SPDX-License-Identifier: Apache-2.0
// The lists of all contexts and what comes to them: context c is at list c % Lists, where it is number c / Lists, in a
// photon_gatherer_candidates that tests the sides of its beats' photons. Who asks what was found, a sum, asks for one
// context: its bound, which its list writes as it changes, and what its list counted, of a sum's several lists that one's.
//
// Lists candidates a cycle; latencies are those of photon_gatherer_candidates. One token and one snapshot are under way.
module photon_gatherer_lists #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Lists = 1,
    parameter int unsigned Sums = 1,  // at most Lists; sum s has the contexts c with c % Sums = s, as c / Sums
    parameter int unsigned Lanes = 4,
    parameter int unsigned RowBits = 6,  // of the FIFO of beats
    parameter int unsigned Behind = 16,  // and how many rows may have left it
    parameter bit Wide = 1'b0,  // of several trees and lists
    parameter bit ReadAlways = Wide,  // as in photon_gatherer_pairs
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
    localparam int unsigned K = photonloom_pkg::K,
    localparam int unsigned CountBits = photonloom_pkg::CountBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned IndexBits = photonloom_pkg::IndexBits,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned LoadBits = 2 * DirectionBits + photonloom_pkg::Channels * photonloom_pkg::MantissaBits +
        photonloom_pkg::ExponentBits,
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits,
    localparam int unsigned Beats = photonloom_pkg::Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned StepBits = $clog2(2 * Lists + 1)
) (
    input  logic                                   clk_i,
    input  logic                                   rst_i,
    // a query starts
    input  logic                                   start_i,
    input  logic [                ContextBits-1:0] start_context_i,
    input  logic [           3*(NormalBits+2)-1:0] start_normal_i,     // decoded, z negated
    // its list is emptied
    input  logic                                   token_i,
    output logic                                   token_taken_o,
    input  logic [                ContextBits-1:0] token_context_i,
    input  logic [                     R2Bits-1:0] token_r2_max_i,     // held until done
    output logic                                   token_done_o,
    // beats, for each list; of those in hand which directions are read, and which loads, in the next cycle
    input  logic [                      Lists-1:0] beat_valid_i,
    output logic [                      Lists-1:0] beat_ready_o,
    input  logic [      Lists*ListContextBits-1:0] beat_context_i,
    input  logic [             Lists*BeatBits-1:0] beat_number_i,
    input  logic [              Lists*RowBits-1:0] beat_row_i,
    input  logic [                      Lists-1:0] beat_last_i,
    input  logic [                Lists*Lanes-1:0] beat_mask_i,
    input  logic [         Lists*Lanes*R2Bits-1:0] beat_d2_i,
    output logic [                      Lists-1:0] direction_read_o,
    input  logic [2*Lists*Lanes*DirectionBits-1:0] directions_i,
    output logic [              Lists*RowBits-1:0] load_row_o,
    input  logic [       Lists*Lanes*LoadBits-1:0] loads_i,
    // the line of a context's leaf
    output logic [      Lists*ListContextBits-1:0] line_context_o,
    input  logic [             Lists*LineBits-1:0] line_i,
    // ends of leaves
    output logic [                      Lists-1:0] leaf_done_o,
    output logic [      Lists*ListContextBits-1:0] leaf_done_context_o,
    // a bound is written, by each list
    output logic [                      Lists-1:0] bound_write_o,
    output logic [      Lists*ListContextBits-1:0] bound_context_o,
    output logic [               Lists*R2Bits-1:0] bound_o,
    // what was found for a context, for each sum
    input  logic [        Sums*SumContextBits-1:0] found_context_i,
    output logic [             Sums*CountBits-1:0] found_count_o,
    output logic [                Sums*R2Bits-1:0] found_r2_o,
    output logic [         Sums*(IndexBits+1)-1:0] found_insertions_o,
    // its photons, of each list: load, d2, index, a cycle after the address
    input  logic [                      Lists-1:0] store_read_i,
    input  logic [      Lists*ListContextBits-1:0] store_context_i,
    input  logic [            Lists*PlaceBits-1:0] store_place_i,
    output logic [            Lists*StoreBits-1:0] store_word_o,
    // a snapshot of their places in list order
    input  logic                                   snapshot_i,
    output logic                                   snapshot_taken_o,
    input  logic [                ContextBits-1:0] snapshot_context_i,
    output logic                                   snapshot_done_o,
    output logic [                  CountBits-1:0] snapshot_count_o,
    output logic [                K*PlaceBits-1:0] snapshot_places_o,
    // counted events, how many
    output logic [                   StepBits-1:0] candidates_o,
    output logic [                   StepBits-1:0] insertions_o
);
  logic [Lists-1:0] token_taken, token_done, snapshot_taken, snapshot_done, candidate, insertion;
  logic [Lists*CountBits-1:0] counts, snapshot_count;
  logic [Lists*(IndexBits+1)-1:0] insertions;
  logic [Lists*K*PlaceBits-1:0] snapshot_places;

  // Whether a start or a snapshot is asked of a list decides whether a pair goes on there, which is late: it is known a cycle ahead.
  // Lists of whole keys have no time for that, since a query starts with its token.
  localparam bit AskLater = Wide && photonloom_pkg::ListCodeBits != 0;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Lists-1:0] token_q, snapshot_q;  // where AskLater
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  if (AskLater) begin : gen_ask_later
    always_ff @(posedge clk_i)
      for (int unsigned l = 0; l < Lists; l++) begin
        token_q[l] <= token_i && (32'(token_context_i) & (Lists - 1)) == l && !token_taken[l] && !rst_i;
        snapshot_q[l] <= snapshot_i && (32'(snapshot_context_i) & (Lists - 1)) == l && !snapshot_taken[l] && !rst_i;
      end
  end

  for (genvar l = 0; l < Lists; l++) begin : gen_list
    localparam int unsigned Sum = l % Sums;
    photon_gatherer_candidates #(
        .Contexts(ListContexts),
        .Lanes(Lanes),
        .RowBits(RowBits),
        .Behind(Behind),
        .Wide(Wide),
        .ReadAlways(ReadAlways),
        .SlowCodes(Wide || (photonloom_pkg::FarGatherers != 0 && Lists == 1 && K > 24))
    ) candidates (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .search_i(start_i && (32'(start_context_i) & (Lists - 1)) == l),
        .search_context_i(ListContextBits'(start_context_i >> $clog2(Lists))),
        .search_normal_i(start_normal_i),
        .start_i(AskLater ? token_q[l] : token_i && (32'(token_context_i) & (Lists - 1)) == l),
        .start_taken_o(token_taken[l]),
        .start_context_i(ListContextBits'(token_context_i >> $clog2(Lists))),
        .start_r2_max_i(token_r2_max_i),
        .start_done_o(token_done[l]),
        .in_valid_i(beat_valid_i[l]),
        .in_ready_o(beat_ready_o[l]),
        .in_context_i(beat_context_i[ListContextBits*l+:ListContextBits]),
        .in_beat_i(beat_number_i[BeatBits*l+:BeatBits]),
        .in_row_i(beat_row_i[RowBits*l+:RowBits]),
        .in_last_i(beat_last_i[l]),
        .in_mask_i(beat_mask_i[Lanes*l+:Lanes]),
        .in_d2_i(beat_d2_i[Lanes*R2Bits*l+:Lanes*R2Bits]),
        .direction_read_o(direction_read_o[l]),
        .directions_i(directions_i[2*Lanes*DirectionBits*l+:2*Lanes*DirectionBits]),
        .load_row_o(load_row_o[RowBits*l+:RowBits]),
        .loads_i(loads_i[Lanes*LoadBits*l+:Lanes*LoadBits]),
        .line_context_o(line_context_o[ListContextBits*l+:ListContextBits]),
        .line_i(line_i[LineBits*l+:LineBits]),
        .leaf_done_o(leaf_done_o[l]),
        .leaf_done_context_o(leaf_done_context_o[ListContextBits*l+:ListContextBits]),
        .bound_write_o(bound_write_o[l]),
        .bound_context_o(bound_context_o[ListContextBits*l+:ListContextBits]),
        .bound_o(bound_o[R2Bits*l+:R2Bits]),
        .found_context_i(ListContextBits'(found_context_i[SumContextBits*Sum+:SumContextBits] >> $clog2(Lists / Sums))),
        .found_count_o(counts[CountBits*l+:CountBits]),
        .found_insertions_o(insertions[(IndexBits+1)*l+:IndexBits+1]),
        .store_read_i(store_read_i[l]),
        .store_context_i(store_context_i[ListContextBits*l+:ListContextBits]),
        .store_place_i(store_place_i[PlaceBits*l+:PlaceBits]),
        .store_word_o(store_word_o[StoreBits*l+:StoreBits]),
        .snapshot_i(AskLater ? snapshot_q[l] : snapshot_i && (32'(snapshot_context_i) & (Lists - 1)) == l),
        .snapshot_taken_o(snapshot_taken[l]),
        .snapshot_context_i(ListContextBits'(snapshot_context_i >> $clog2(Lists))),
        .snapshot_done_o(snapshot_done[l]),
        .snapshot_count_o(snapshot_count[CountBits*l+:CountBits]),
        .snapshot_places_o(snapshot_places[K*PlaceBits*l+:K*PlaceBits]),
        .candidates_o(candidate[l]),
        .insertions_o(insertion[l])
    );
  end

  // ---- one token and one snapshot are under way ----
  assign token_taken_o = token_taken != '0;
  assign token_done_o = token_done != '0;
  assign snapshot_taken_o = snapshot_taken != '0;
  assign snapshot_done_o = snapshot_done != '0;
  always_comb begin
    snapshot_count_o = '0;
    snapshot_places_o = '0;
    candidates_o = '0;
    insertions_o = '0;
    for (int unsigned l = 0; l < Lists; l++) begin
      if (Lists == 1 || snapshot_done[l]) begin
        snapshot_count_o = snapshot_count_o | snapshot_count[CountBits*l+:CountBits];
        snapshot_places_o = snapshot_places_o | snapshot_places[K*PlaceBits*l+:K*PlaceBits];
      end
      candidates_o = candidates_o + StepBits'(candidate[l]);
      insertions_o = insertions_o + StepBits'(insertion[l]);
    end
  end

  // ---- what was found: of the list that has the context ----
  for (genvar sum = 0; sum < Sums; sum++) begin : gen_found
    localparam int unsigned Choices = Lists / Sums;
    logic [SumContextBits-1:0] context_found;
    assign context_found = found_context_i[SumContextBits*sum+:SumContextBits];
    photon_gatherer_bounds #(
        .Contexts(Contexts),
        .Lists(Lists),
        .Copies(Sums),
        .Copy(sum),
        .R2Bits(R2Bits)
    ) bounds (
        .clk_i(clk_i),
        .write_i(bound_write_o),
        .write_context_i(bound_context_o),
        .write_bound_i(bound_o),
        .read_context_i(context_found),
        .read_bound_o(found_r2_o[R2Bits*sum+:R2Bits])
    );
    always_comb begin
      found_count_o[CountBits*sum+:CountBits] = counts[CountBits*sum+:CountBits];
      found_insertions_o[(IndexBits+1)*sum+:IndexBits+1] = insertions[(IndexBits+1)*sum+:IndexBits+1];
      for (int unsigned i = 1; i < Choices; i++) begin
        if ((32'(context_found) & (Choices - 1)) == i) begin
          found_count_o[CountBits*sum+:CountBits] = counts[CountBits*(Sums*i+sum)+:CountBits];
          found_insertions_o[(IndexBits+1)*sum+:IndexBits+1] = insertions[(IndexBits+1)*(Sums*i+sum)+:IndexBits+1];
        end
      end
    end
  end
endmodule
