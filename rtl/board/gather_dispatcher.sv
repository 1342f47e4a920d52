// SPDX-License-Identifier: Apache-2.0
// Deals queries to Gatherers photon gatherers and gives their results and photons back in the order of the queries. A query
// goes to the next gatherer in turn that has room, so a slow query holds up its own gatherer only, until Pending queries
// are between deal and result. Which gatherer answers a query cannot be seen: all hold the same maps.
//
// The order of deal waits in a FIFO; results are fetched by it into a FIFO of 16. Where a query wants photons and its
// result says that it has some, the gatherer's number goes on into the order of photons. That FIFO holds every query that
// can have photons waiting, so photons never hold up results; results that nobody takes hold up photons of queries 16
// results on, from far 14. Each gatherer gives both streams in the order of its queries, and the query that is next in either order is
// the oldest of its gatherer: so there is always one that can go on (docs/gather_cluster.md).
//
// Each stream from and to a gatherer passes a skid buffer here, so no path leads from one gatherer through the dispatcher
// to another, nor back to the same one; up to two queries wait for a gatherer that is full. Where gatherers lie far away
// (photonloom_pkg::FarGatherers) photons pass two, results come in words, and known a cycle ahead are the gatherer that gets the
// next query and whether there is room for its number and for a result.
//
// One query, one result and one photon a cycle; latency of each 2 to 4 cycles, of photons that come from far 3 to 5. From far each
// gatherer gives one result in 9 cycles, whose words take 10. With TurnLater there is a cycle between the photons of two queries.
module gather_dispatcher #(
    parameter int unsigned Gatherers = photonloom_pkg::Gatherers,
    // Of a gatherer 64, four for each of its contexts where that is more: results leave in order, so a slow query holds up the
    // others once so many are behind it.
    parameter int unsigned Pending = (4 * photonloom_pkg::Contexts > 64 ? 4 * photonloom_pkg::Contexts : 64) * Gatherers,
    // Gatherers of so many contexts or nodes fill the part, and the buffers of their photons lie far from what says whose turn it is.
    parameter bit TurnLater = photonloom_pkg::FarGatherers != 0 && (photonloom_pkg::Contexts > 16 || photonloom_pkg::NodesPerCycle > 1),
    localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits,
    localparam int unsigned ResultBits = photonloom_pkg::GatherResultPacketBits,
    localparam int unsigned PhotonBits = photonloom_pkg::GatherPhotonPacketBits
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    // queries
    input  logic                              in_valid_i,
    output logic                              in_ready_o,
    input  photonloom_pkg::gather_query_t     in_i,
    // results
    output logic                              result_valid_o,
    input  logic                              result_ready_i,
    output photonloom_pkg::gather_result_t    result_o,
    // photons
    output logic                              photon_valid_o,
    input  logic                              photon_ready_i,
    output photonloom_pkg::gather_photon_t    photon_o,
    // the gatherers' streams, gatherer 0 lowest
    output logic [             Gatherers-1:0] query_valid_o,
    input  logic [             Gatherers-1:0] query_ready_i,
    output logic [   Gatherers*QueryBits-1:0] query_o,
    input  logic [             Gatherers-1:0] result_valid_i,
    output logic [             Gatherers-1:0] result_ready_o,
    input  logic [  Gatherers*ResultBits-1:0] result_i,
    input  logic [             Gatherers-1:0] photon_valid_i,
    output logic [             Gatherers-1:0] photon_ready_o,
    input  logic [  Gatherers*PhotonBits-1:0] photon_i,
    // a result was fetched, and its query wants photons but has none
    output logic                              fetched_o,
    output logic                              no_photons_o,
    output photonloom_pkg::gather_result_t    fetched_result_o
);
  localparam int unsigned SourceBits = Gatherers > 1 ? $clog2(Gatherers) : 1;
  localparam int unsigned OrderDepth = Pending > 2 ? 1 << $clog2(Pending) : 2;
  // Photons of so many queries wait in a gatherer at most: of those that keep a context for them, and of a few that gave it
  // back but whose last photons are still at its port or in the skid buffers behind it.
  localparam int unsigned HoldersOfPhotons =
      Gatherers * (photonloom_pkg::Contexts + (photonloom_pkg::FarGatherers != 0 ? 12 : 10));
  localparam int unsigned PhotonDepth = HoldersOfPhotons > 2 ? 1 << $clog2(HoldersOfPhotons) : 2;

  localparam int unsigned ResultDepth = 16;
  localparam int unsigned ResultWords = 8;  // of far gatherers
  localparam int unsigned ResultWordBits = (ResultBits + ResultWords - 1) / ResultWords;

  localparam int Far = photonloom_pkg::FarGatherers != 0 ? Gatherers : 0;

  // ---- deal ----
  logic query_valid, query_taken, order_ready;
  photonloom_pkg::gather_query_t query;
  logic [Gatherers-1:0] above_q, room, first, any, grant, deal;
  logic [SourceBits-1:0] grant_source;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Gatherers-1:0] left, grant_q;  // of far gatherers
  logic order_room, results_room;  // known ahead
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  skid_buffer #(
      .Width(QueryBits)
  ) incoming (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .out_valid_o(query_valid),
      .out_ready_i(query_taken),
      .out_o(query)
  );

  // Gatherers above the last one served come before the others.
  assign first = (Far != 0 ? left : room) & above_q;
  assign any = first != '0 ? first : Far != 0 ? left : room;
  assign grant = Far != 0 ? grant_q : any & (~any + 1'b1);
  assign deal = query_valid && (Far != 0 ? order_room : order_ready) ? grant : '0;
  assign query_taken = deal != '0;
  always_comb begin
    grant_source = '0;
    for (int unsigned g = 0; g < Gatherers; g++) if (grant[g]) grant_source = grant_source | SourceBits'(g);
  end
  always_ff @(posedge clk_i) begin
    if (query_taken) above_q <= ~(grant | (grant - 1'b1));
    if (rst_i) above_q <= '1;
  end

  // Of far gatherers which one is next is known a cycle ahead. Only a deal takes room away, so the one whose turn it is is left out, also
  // where there is no query for it.
  if (Far != 0) begin : gen_grant_ahead
    assign left = room & ~grant_q;
    always_ff @(posedge clk_i) begin
      for (int unsigned g = 0; g < Gatherers; g++) grant_q[g] <= any[g] && (any & ((Gatherers'(1) << g) - 1'b1)) == '0;
      if (rst_i) grant_q <= '0;
    end
  end

  // ---- what lies between a gatherer and the rest. Photons from far: beside the gatherer, and once more here, which has the lower
  // numbers. ----
  logic [Gatherers-1:0] result_valid, result_ready;
  logic [Gatherers*ResultBits-1:0] result_words;
  logic [Far+Gatherers-1:0] photon_valid, photon_ready;
  logic [(Far+Gatherers)*PhotonBits-1:0] photon_words;

  for (genvar g = 0; g < Gatherers; g++) begin : gen_gatherer
    skid_buffer #(
        .Width(QueryBits)
    ) query_out (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(deal[g]),
        .in_ready_o(room[g]),
        .in_i(query),
        .out_valid_o(query_valid_o[g]),
        .out_ready_i(query_ready_i[g]),
        .out_o(query_o[QueryBits*g+:QueryBits])
    );
    skid_buffer #(
        .Width(PhotonBits)
    ) photon_in (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(photon_valid_i[g]),
        .in_ready_o(photon_ready_o[g]),
        .in_i(photon_i[PhotonBits*g+:PhotonBits]),
        .out_valid_o(photon_valid[Far+g]),
        .out_ready_i(photon_ready[Far+g]),
        .out_o(photon_words[PhotonBits*(Far+g)+:PhotonBits])
    );
    if (Far != 0) begin : gen_far
      // A result of a far gatherer comes in words, which are few wires: it needs many cycles for each.
      logic sent_valid, sent_ready, word_valid, word_ready;
      logic [ResultWordBits-1:0] sent, word;
      word_sender #(
          .Width(ResultBits),
          .Words(ResultWords)
      ) result_out (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(result_valid_i[g]),
          .in_ready_o(result_ready_o[g]),
          .in_i(result_i[ResultBits*g+:ResultBits]),
          .out_valid_o(sent_valid),
          .out_ready_i(sent_ready),
          .out_o(sent)
      );
      skid_buffer #(
          .Width(ResultWordBits)
      ) result_between (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(sent_valid),
          .in_ready_o(sent_ready),
          .in_i(sent),
          .out_valid_o(word_valid),
          .out_ready_i(word_ready),
          .out_o(word)
      );
      word_receiver #(
          .Width(ResultBits),
          .Words(ResultWords)
      ) result_in (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(word_valid),
          .in_ready_o(word_ready),
          .in_i(word),
          .out_valid_o(result_valid[g]),
          .out_ready_i(result_ready[g]),
          .out_o(result_words[ResultBits*g+:ResultBits])
      );
      skid_buffer #(
          .Width(PhotonBits)
      ) photon_near (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(photon_valid[Far+g]),
          .in_ready_o(photon_ready[Far+g]),
          .in_i(photon_words[PhotonBits*(Far+g)+:PhotonBits]),
          .out_valid_o(photon_valid[g]),
          .out_ready_i(photon_ready[g]),
          .out_o(photon_words[PhotonBits*g+:PhotonBits])
      );
    end else begin : gen_near
      skid_buffer #(
          .Width(ResultBits)
      ) result_in (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(result_valid_i[g]),
          .in_ready_o(result_ready_o[g]),
          .in_i(result_i[ResultBits*g+:ResultBits]),
          .out_valid_o(result_valid[g]),
          .out_ready_i(result_ready[g]),
          .out_o(result_words[ResultBits*g+:ResultBits])
      );
    end
  end

  logic order_valid, order_taken, next_valid, next_taken, next_wants;
  logic [SourceBits:0] order_word;
  logic [SourceBits-1:0] next_source;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic [Gatherers-1:0] next_turn;  // of far gatherers
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */

  fifo #(
      .Width(SourceBits + 1),
      .Depth(OrderDepth)
  ) order (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(query_taken),
      .in_ready_o(order_ready),
      .in_i({query.want_photons && !query.flush, grant_source}),
      .out_valid_o(order_valid),
      .out_ready_i(order_taken),
      .out_o(order_word)
  );
  if (Far != 0) begin : gen_turn_ahead
    // Whose turn it is is known a cycle ahead.
    logic near_valid, near_taken;
    logic [SourceBits:0] near_word;
    logic [Gatherers-1:0] near_turn;
    skid_buffer #(
        .Width(SourceBits + 1)
    ) order_near (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(order_valid),
        .in_ready_o(order_taken),
        .in_i(order_word),
        .out_valid_o(near_valid),
        .out_ready_i(near_taken),
        .out_o(near_word)
    );
    always_comb for (int unsigned g = 0; g < Gatherers; g++) near_turn[g] = near_word[SourceBits-1:0] == SourceBits'(g);
    skid_buffer #(
        .Width(Gatherers + SourceBits + 1)
    ) order_next (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(near_valid),
        .in_ready_o(near_taken),
        .in_i({near_turn, near_word}),
        .out_valid_o(next_valid),
        .out_ready_i(next_taken),
        .out_o({next_turn, next_wants, next_source})
    );
  end else begin : gen_turn
    skid_buffer #(
        .Width(SourceBits + 1)
    ) order_next (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(order_valid),
        .in_ready_o(order_taken),
        .in_i(order_word),
        .out_valid_o(next_valid),
        .out_ready_i(next_taken),
        .out_o({next_wants, next_source})
    );
  end

  if (Far != 0) begin : gen_room_ahead
    room_ahead #(
        .Depth(OrderDepth)
    ) of_order (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .push_i(query_taken),
        .pop_i(order_valid && order_taken),
        .room_o(order_room)
    );
    room_ahead #(
        .Depth(ResultDepth)
    ) of_results (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .push_i(next_taken),
        .pop_i(result_valid_o && result_ready_i),
        .room_o(results_room)
    );
  end

  // ---- results ----
  logic [Gatherers-1:0] result_turn;
  logic [ResultBits-1:0] result_word;
  logic results_ready;

  always_comb begin
    result_turn = '0;
    result_word = '0;
    for (int unsigned g = 0; g < Gatherers; g++)
      if (Far != 0 ? next_turn[g] : next_source == SourceBits'(g)) begin
        result_turn[g] = 1'b1;
        result_word = result_word | result_words[ResultBits*g+:ResultBits];
      end
  end
  assign result_ready = next_valid && (Far != 0 ? results_room : results_ready) ? result_turn : '0;
  assign next_taken = (result_ready & result_valid) != '0;

  fifo #(
      .Width(ResultBits),
      .Depth(ResultDepth)
  ) results (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(next_taken),
      .in_ready_o(results_ready),
      .in_i(result_word),
      .out_valid_o(result_valid_o),
      .out_ready_i(result_ready_i),
      .out_o(result_o)
  );

  logic [ResultBits-1:0] fetched_q;
  logic wants_q;
  logic [SourceBits-1:0] source_q;
  assign fetched_result_o = fetched_q;
  assign no_photons_o = fetched_o && wants_q && fetched_result_o.count == '0;
  always_ff @(posedge clk_i) begin
    fetched_q <= result_word;
    fetched_o <= next_taken;
    wants_q <= next_wants;
    source_q <= next_source;
    if (rst_i) fetched_o <= 1'b0;
  end

  // ---- photons ----
  logic turn_valid, turn_taken, photons_ready, photon_offered;
  logic [SourceBits-1:0] turn_source;
  logic [Gatherers-1:0] photon_turn;
  photonloom_pkg::gather_photon_t photon_word;
  /* verilator lint_off UNUSEDSIGNAL */  // has room for every query whose photons can wait
  logic turns_ready;
  /* verilator lint_on UNUSEDSIGNAL */
  logic waiting_valid, waiting_taken, after_valid, after_taken;
  logic [SourceBits-1:0] waiting_source, after_source;

  fifo #(
      .Width(SourceBits),
      .Depth(PhotonDepth)
  ) photon_turns (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(fetched_o && wants_q && !no_photons_o),
      .in_ready_o(turns_ready),
      .in_i(source_q),
      .out_valid_o(waiting_valid),
      .out_ready_i(waiting_taken),
      .out_o(waiting_source)
  );
  // The choice among so many words of LUT RAM, whose photons are next, and which gatherer's that makes, would be too much for a
  // cycle.
  if (PhotonDepth > 128 || Far != 0) begin : gen_turn_register
    skid_buffer #(
        .Width(SourceBits)
    ) turn_next (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(waiting_valid),
        .in_ready_o(waiting_taken),
        .in_i(waiting_source),
        .out_valid_o(after_valid),
        .out_ready_i(after_taken),
        .out_o(after_source)
    );
  end else begin : gen_no_register
    assign after_valid = waiting_valid;
    assign waiting_taken = after_taken;
    assign after_source = waiting_source;
  end
  if (TurnLater) begin : gen_turn_later
    // That a photon was the last decides of one flip-flop here, not of the buffer before it.
    logic holds_q;
    logic [SourceBits-1:0] holder_q;
    always_ff @(posedge clk_i) begin
      holds_q <= holds_q ? !turn_taken : after_valid;
      if (!holds_q) holder_q <= after_source;
      if (rst_i) holds_q <= 1'b0;
    end
    assign turn_valid = holds_q;
    assign turn_source = holder_q;
    assign after_taken = !holds_q;
  end else begin : gen_turn_at_once
    assign turn_valid = after_valid;
    assign turn_source = after_source;
    assign after_taken = turn_taken;
  end

  logic [PhotonBits-1:0] photon_bits;
  assign photon_word = photon_bits;
  always_comb begin
    photon_turn = '0;
    photon_bits = '0;
    for (int unsigned g = 0; g < Gatherers; g++)
      if (turn_source == SourceBits'(g)) begin
        photon_turn[g] = 1'b1;
        photon_bits = photon_bits | photon_words[PhotonBits*g+:PhotonBits];
      end
  end
  assign photon_ready[Gatherers-1:0] = turn_valid && photons_ready ? photon_turn : '0;
  assign photon_offered = (photon_turn & photon_valid[Gatherers-1:0]) != '0 && turn_valid;
  assign turn_taken = photon_offered && photons_ready && photon_word.last;

  skid_buffer #(
      .Width(PhotonBits)
  ) photons (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(photon_offered),
      .in_ready_o(photons_ready),
      .in_i(photon_word),
      .out_valid_o(photon_valid_o),
      .out_ready_i(photon_ready_i),
      .out_o(photon_o)
  );

`ifndef SYNTHESIS
  always_ff @(posedge clk_i) if (!rst_i) assert (!(fetched_o && wants_q) || turns_ready);
`endif
endmodule
