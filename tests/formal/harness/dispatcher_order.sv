// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/skid_buffer.sv rtl/board/gather_dispatcher.sv
// sources: tests/formal/harness/stubs/fifo.sv tests/formal/harness/dispatcher_model.sv
// sources: tests/formal/harness/stream_checks.sv tests/formal/harness/in_a_row.sv tests/formal/harness/pair_inside.sv
// gather_dispatcher with two gatherers that take as long as they like: results come out in the order of the queries, once
// and unchanged (Photons 0); photons come out query by query in that order, each query's together and whole (Photons 1); a
// FIFO that may not overflow does not. A query's lowest position bit says whether it has photons if it wants them; those that
// have some are what stream_checks follows with Photons 1.
//
// What makes it hold in each cycle is asserted with it (Lemmas 1), so that a proof needs no more than one step. Two lists note
// the queries between deal and fetch, and those with photons between fetch and last photon. The order FIFO holds the sources
// of the one, the order of photons those of the other; what lies in and around a gatherer is those entries that it got, in
// their order; and results, lists and what waits for its deal, read one after the other, are the stream that came.
module dispatcher_order #(
    parameter int unsigned Photons = 0,
    parameter int unsigned Law = 0,
    parameter int unsigned Lemmas = 0
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic result_ready_i,
    input logic photon_ready_i,
    input logic [5:0] idle_i
);
  logic in_ready, result_valid, photon_valid, fetched;
  photonloom_pkg::gather_result_t result, fetched_result;
  photonloom_pkg::gather_photon_t photon;
  logic [1:0] query_valid, query_ready, gatherer_result_valid, gatherer_result_ready, gatherer_photon_valid,
      gatherer_photon_ready;
  logic [3:0] gatherer_result, gatherer_photon;
  logic [2*photonloom_pkg::GatherQueryPacketBits-1:0] queries;

  gather_dispatcher #(
      .Gatherers(2),
      .Pending(2)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .result_valid_o(result_valid),
      .result_ready_i(result_ready_i),
      .result_o(result),
      .photon_valid_o(photon_valid),
      .photon_ready_i(photon_ready_i),
      .photon_o(photon),
      .query_valid_o(query_valid),
      .query_ready_i(query_ready),
      .query_o(queries),
      .result_valid_i(gatherer_result_valid),
      .result_ready_o(gatherer_result_ready),
      .result_i(gatherer_result),
      .photon_valid_i(gatherer_photon_valid),
      .photon_ready_o(gatherer_photon_ready),
      .photon_i(gatherer_photon),
      .fetched_o(fetched),
      .no_photons_o(),
      .fetched_result_o(fetched_result)
  );

  // ---- registers and wires inside, by their flattened names ----
  // Of a skid buffer the ports show all but the spare word: it is there while the buffer is not ready.
  localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits;
  (* hierconn *) logic \dut.query_valid , \dut.query_taken , \dut.order_taken , \dut.next_valid , \dut.next_wants ;
  (* hierconn *) logic \dut.next_source , \dut.next_taken , \dut.wants_q , \dut.source_q , \dut.turn_taken , \dut.photons_ready ;
  (* hierconn *) logic [1:0] \dut.grant , \dut.room , \dut.result_valid , \dut.photon_valid ;
  (* hierconn *) logic [3:0] \dut.result_words , \dut.photon_words ;
  (* hierconn *) logic [1:0] \dut.order.valid_q ;
  (* hierconn *) logic [3:0] \dut.order.words_q , \dut.results.valid_q ;
  (* hierconn *) logic [7:0] \dut.results.words_q ;
  (* hierconn *) logic [7:0] \dut.photon_turns.valid_q , \dut.photon_turns.words_q ;
  (* hierconn *) logic [QueryBits-1:0] \dut.query , \dut.incoming.spare_q ;
  (* hierconn *) logic [1:0] \dut.gen_turn.order_next.spare_q , \dut.photons.spare_q ;
  (* hierconn *) logic [QueryBits-1:0] \dut.gen_gatherer[0].query_out.spare_q , \dut.gen_gatherer[1].query_out.spare_q ;
  (* hierconn *) logic [1:0] \dut.gen_gatherer[0].gen_near.result_in.spare_q , \dut.gen_gatherer[1].gen_near.result_in.spare_q ;
  (* hierconn *) logic [1:0] \dut.gen_gatherer[0].photon_in.spare_q , \dut.gen_gatherer[1].photon_in.spare_q ;
  logic [2*QueryBits-1:0] query_spares;
  logic [3:0] result_spares, photon_spares;
  assign query_spares  = {\dut.gen_gatherer[1].query_out.spare_q , \dut.gen_gatherer[0].query_out.spare_q };
  assign result_spares = {\dut.gen_gatherer[1].gen_near.result_in.spare_q , \dut.gen_gatherer[0].gen_near.result_in.spare_q };
  assign photon_spares = {\dut.gen_gatherer[1].photon_in.spare_q , \dut.gen_gatherer[0].photon_in.spare_q };

  photonloom_pkg::gather_query_t dealing, spare_in;
  assign dealing  = \dut.query ;
  assign spare_in = \dut.incoming.spare_q ;
  logic dealing_wants, spare_wants;
  assign dealing_wants = dealing.want_photons && !dealing.flush;
  assign spare_wants   = spare_in.want_photons && !spare_in.flush;

  // ---- the two lists ----
  // dealt: queries between deal and fetch, as many as the order FIFO and the skid buffer behind it hold, each with its tags,
  // whether it has photons, whether it wants them, and its gatherer. owing: queries between fetch and last photon, six at
  // most (three a gatherer), each with its second tag bit and its gatherer.
  localparam int unsigned Dealt = 4;
  localparam int unsigned Owing = 8;
  (* hierconn *) logic [Dealt-1:0] \dealt.valid_q ;
  (* hierconn *) logic [5*Dealt-1:0] \dealt.words_q ;
  (* hierconn *) logic [Owing-1:0] \owing.valid_q ;
  (* hierconn *) logic [2*Owing-1:0] \owing.words_q ;
  logic [4:0] dealt_word;
  fifo #(
      .Width(5),
      .Depth(4)
  ) dealt (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(\dut.query_taken ),
      .in_ready_o(),
      .in_i({dealing.tag, dealing.position[0], dealing_wants, \dut.grant [1]}),
      .out_valid_o(),
      .out_ready_i(\dut.next_taken ),
      .out_o(dealt_word)
  );
  fifo #(
      .Width(2),
      .Depth(32)
  ) owing (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(\dut.next_taken && dealt_word[1] && dealt_word[2]),
      .in_ready_o(),
      .in_i({dealt_word[4], dealt_word[0]}),
      .out_valid_o(),
      .out_ready_i(\dut.turn_taken ),
      .out_o()
  );

  // Their fields, place by place.
  logic [Dealt-1:0] dealt_source, dealt_wants, dealt_has, dealt_result_tag, dealt_photon_tag;
  logic [Owing-1:0] owing_source, owing_tag;
  logic [2*Dealt-1:0] dealt_order, dealt_results;
  logic [4*Dealt-1:0] dealt_latest;  // the latest lowest
  logic [Dealt-1:0] dealt_latest_valid, dealt_latest_source;
  always_comb begin
    for (int unsigned i = 0; i < Dealt; i++) begin
      {dealt_photon_tag[i], dealt_result_tag[i], dealt_has[i], dealt_wants[i], dealt_source[i]} = \dealt.words_q [5*i+:5];
      dealt_order[2*i+:2] = {dealt_wants[i], dealt_source[i]};
      dealt_results[2*i+:2] = {dealt_result_tag[i], dealt_has[i]};
      dealt_latest[4*(Dealt-1-i)+:4] = {dealt_photon_tag[i], dealt_result_tag[i], dealt_has[i], dealt_wants[i]};
      dealt_latest_valid[Dealt-1-i] = \dealt.valid_q [i];
      dealt_latest_source[Dealt-1-i] = dealt_source[i];
    end
    for (int unsigned i = 0; i < Owing; i++) {owing_tag[i], owing_source[i]} = \owing.words_q [2*i+:2];
  end

  // ---- the order FIFO holds the sources of one, the order of photons those of the other ----
  logic [11:0] order_row;
  logic [3*Dealt-1:0] dealt_row;
  logic [17:0] turns_row;
  logic [2*Owing-1:0] owing_row;
  in_a_row #(
      .Places(4),
      .Width(2)
  ) order_words (
      .valid_i({\dut.order.valid_q , !\dut.order_taken , \dut.next_valid }),
      .words_i({\dut.order.words_q , \dut.gen_turn.order_next.spare_q , \dut.next_wants , \dut.next_source }),
      .row_o(order_row)
  );
  in_a_row #(
      .Places(Dealt),
      .Width(2)
  ) dealt_words (
      .valid_i(\dealt.valid_q ),
      .words_i(dealt_order),
      .row_o(dealt_row)
  );
  in_a_row #(
      .Places(9),
      .Width(1)
  ) turns_words (
      .valid_i({fetched && \dut.wants_q && fetched_result.count, \dut.photon_turns.valid_q }),
      .words_i({\dut.source_q , \dut.photon_turns.words_q }),
      .row_o(turns_row)
  );
  in_a_row #(
      .Places(Owing),
      .Width(1)
  ) owing_words (
      .valid_i(\owing.valid_q ),
      .words_i(owing_source),
      .row_o(owing_row)
  );

  // Words of a shift register stand without gaps, and a skid buffer's spare word behind another.
  always_comb begin
    if (Lemmas == 1 && !rst_i) begin
      assert (order_row == dealt_row);
      assert (turns_row == owing_row);
      assert ((\dealt.valid_q & (\dealt.valid_q + 1'b1)) == '0);
      assert ((\owing.valid_q & (\owing.valid_q + 1'b1)) == '0);
      assert ((\dut.order.valid_q & (\dut.order.valid_q + 1'b1)) == '0);
      assert ((\dut.results.valid_q & (\dut.results.valid_q + 1'b1)) == '0);
      assert ((\dut.photon_turns.valid_q & (\dut.photon_turns.valid_q + 1'b1)) == '0);
      assert (in_ready || \dut.query_valid );
      assert (\dut.order_taken || \dut.next_valid );
      assert (\dut.photons_ready || photon_valid);
    end
  end

  // ---- the halves of photons ----
  // Two photons of a query, the last marked, of one tag. Read from what was taken on, through the dispatcher's last skid buffer,
  // they alternate; a half that is left there belongs to the query that is owed photons longest.
  logic second_q, tag_q, half, half_tag;
  logic [1:0] leaving_valid, leaving_last, leaving_tag;
  assign leaving_valid = {!\dut.photons_ready , photon_valid};
  assign leaving_last  = {\dut.photons.spare_q [0], photon.last};
  assign leaving_tag   = {\dut.photons.spare_q [1], photon.tag};
  logic leaving_fits;
  always_ff @(posedge clk_i) begin
    if (photon_valid && photon_ready_i) begin
      second_q <= !photon.last;
      tag_q <= photon.tag;
    end
    if (rst_i) second_q <= 1'b0;
  end
  always_comb begin
    half = second_q;
    half_tag = tag_q;
    leaving_fits = 1'b1;
    for (int unsigned i = 0; i < 2; i++) begin
      if (leaving_valid[i]) begin
        if (leaving_last[i] != half || (half && leaving_tag[i] != half_tag)) leaving_fits = 1'b0;
        half = !leaving_last[i];
        half_tag = leaving_tag[i];
      end
    end
    if (Lemmas == 1 && !rst_i) begin
      assert (leaving_fits);
      assert (!half || (\owing.valid_q [0] && owing_tag[0] == half_tag));
    end
  end

  // ---- in and around a gatherer are the entries that it got ----
  for (genvar g = 0; g < 2; g++) begin : gen_gatherer
    photonloom_pkg::gather_query_t query, spare;
    logic wants, spare_wants;
    assign query = queries[QueryBits*g+:QueryBits];
    assign spare = query_spares[QueryBits*g+:QueryBits];
    assign wants = query.want_photons && !query.flush;
    assign spare_wants = spare.want_photons && !spare.flush;
    dispatcher_model gatherer (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .idle_i(idle_i[3*g+:3]),
        .query_valid_i(query_valid[g]),
        .query_ready_o(query_ready[g]),
        .query_tag_i(query.tag),
        .query_wants_i(wants),
        .query_has_i(query.position[0]),
        .result_valid_o(gatherer_result_valid[g]),
        .result_ready_i(gatherer_result_ready[g]),
        .result_o(gatherer_result[2*g+:2]),
        .photon_valid_o(gatherer_photon_valid[g]),
        .photon_ready_i(gatherer_photon_ready[g]),
        .photon_o(gatherer_photon[2*g+:2])
    );
    (* hierconn *) logic [1:0] \gatherer.results.valid_q , \gatherer.photons.valid_q , \gatherer.photons.words_q ;
    (* hierconn *) logic [3:0] \gatherer.results.words_q ;
    (* hierconn *) logic \gatherer.second_q ;

    logic [1:0] result_spare, photon_spare, photon_main;
    assign result_spare = result_spares[2*g+:2];
    assign photon_spare = photon_spares[2*g+:2];
    assign photon_main  = \dut.photon_words [2*g+:2];
    logic [Dealt-1:0] mine, mine_latest, mine_photons;
    logic [Owing-1:0] mine_owing;
    assign mine = \dealt.valid_q & (g == 1 ? dealt_source : ~dealt_source);
    assign mine_latest = dealt_latest_valid & (g == 1 ? dealt_latest_source : ~dealt_latest_source);
    assign mine_photons = mine & dealt_wants & dealt_has;
    assign mine_owing = \owing.valid_q & (g == 1 ? owing_source : ~owing_source);

    // Results: behind the gatherer, in it, before it.
    logic [17:0] result_row;
    logic [3*Dealt-1:0] mine_row;
    in_a_row #(
        .Places(6),
        .Width(2)
    ) result_words (
        .valid_i({
          !\dut.room [g], query_valid[g], \gatherer.results.valid_q , !gatherer_result_ready[g], \dut.result_valid [g]
        }),
        .words_i({
          {spare.tag[0], spare.position[0]},
          {query.tag[0], query.position[0]},
          \gatherer.results.words_q ,
          result_spare,
          \dut.result_words [2*g+:2]
        }),
        .row_o(result_row)
    );
    in_a_row #(
        .Places(Dealt),
        .Width(2)
    ) mine_words (
        .valid_i(mine),
        .words_i(dealt_results),
        .row_o(mine_row)
    );

    // Photons of whole queries: those whose last one lies behind the gatherer, in it, before it.
    logic [11:0] photon_row;
    logic [2*(Dealt+Owing)-1:0] mine_photon_row;
    in_a_row #(
        .Places(6),
        .Width(1)
    ) photon_words (
        .valid_i({
          !\dut.room [g] && spare_wants && spare.position[0],
          query_valid[g] && wants && query.position[0],
          \gatherer.photons.valid_q ,
          !gatherer_photon_ready[g] && photon_spare[0],
          \dut.photon_valid [g] && photon_main[0]
        }),
        .words_i({spare.tag[1], query.tag[1], \gatherer.photons.words_q , photon_spare[1], photon_main[1]}),
        .row_o(photon_row)
    );
    in_a_row #(
        .Places(Dealt + Owing),
        .Width(1)
    ) mine_photon_words (
        .valid_i({mine_photons, mine_owing}),
        .words_i({dealt_photon_tag, owing_tag}),
        .row_o(mine_photon_row)
    );

    // Queries that the gatherer has not got yet, the latest lowest: none of them is owed photons.
    logic [9:0] waiting_row;
    logic [5*Dealt-1:0] mine_latest_row;
    in_a_row #(
        .Places(2),
        .Width(4)
    ) waiting_words (
        .valid_i({query_valid[g], !\dut.room [g]}),
        .words_i({query.tag, query.position[0], wants, spare.tag, spare.position[0], spare_wants}),
        .row_o(waiting_row)
    );
    in_a_row #(
        .Places(Dealt),
        .Width(4)
    ) mine_latest_words (
        .valid_i(mine_latest),
        .words_i(dealt_latest),
        .row_o(mine_latest_row)
    );

    // Halves of photons, from the dispatcher's last skid buffer on back into the gatherer.
    logic mine_half, mine_half_tag, photons_fit;
    logic [1:0] photon_here, photon_last, photon_tag;
    assign photon_here = {!gatherer_photon_ready[g], \dut.photon_valid [g]};
    assign photon_last = {photon_spare[0], photon_main[0]};
    assign photon_tag  = {photon_spare[1], photon_main[1]};
    always_comb begin
      mine_half = half && owing_source[0] == (g == 1);
      mine_half_tag = half_tag;
      photons_fit = 1'b1;
      for (int unsigned i = 0; i < 2; i++) begin
        if (photon_here[i]) begin
          if (photon_last[i] != mine_half || (mine_half && photon_tag[i] != mine_half_tag)) photons_fit = 1'b0;
          mine_half = !photon_last[i];
          mine_half_tag = photon_tag[i];
        end
      end
      if (Lemmas == 1 && !rst_i) begin
        assert (photons_fit && \gatherer.second_q == mine_half);
        assert (!mine_half || (\gatherer.photons.valid_q [0] && \gatherer.photons.words_q [0] == mine_half_tag));
        assert (result_row == mine_row);
        assert (photon_row == mine_photon_row);
        assert (!waiting_row[4] || mine_latest_row[4:0] == waiting_row[4:0]);
        assert (!waiting_row[9] || mine_latest_row[9:5] == waiting_row[9:5]);
        assert ((\gatherer.results.valid_q & (\gatherer.results.valid_q + 1'b1)) == '0);
        assert ((\gatherer.photons.valid_q & (\gatherer.photons.valid_q + 1'b1)) == '0);
        assert (\dut.room [g] || query_valid[g]);
        assert (gatherer_result_ready[g] || \dut.result_valid [g]);
        assert (gatherer_photon_ready[g] || \dut.photon_valid [g]);
      end
    end
  end

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // ---- the stream, followed ----
  if (Photons == 0) begin : gen_results
    stream_checks #(
        .Order(1 - Law),
        .Law(Law),
        .Progress(0)
    ) checks (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i),
        .in_ready_i(in_ready),
        .in_i(in_i.tag[0]),
        .out_valid_i(result_valid),
        .out_ready_i(result_ready_i),
        .out_i(result.tag)
    );
    (* hierconn *) logic [1:0] \checks.sent_q , \checks.taken_q ;
    logic [3:0] tags;
    for (genvar i = 0; i < 4; i++) begin : gen_tags
      assign tags[i] = \dut.results.words_q [2*i+1];
    end
    if (Lemmas == 1) begin : gen_lemmas
      pair_inside #(
          .Places(Dealt + 6)
      ) pair (
          .rst_i(rst_i),
          .sent_i(\checks.sent_q ),
          .taken_i(\checks.taken_q ),
          .valid_i({!in_ready, \dut.query_valid , \dealt.valid_q , \dut.results.valid_q }),
          .words_i({spare_in.tag[0], dealing.tag[0], dealt_result_tag, tags})
      );
    end
  end else begin : gen_photons
    logic has;
    assign has = in_i.want_photons && !in_i.flush && in_i.position[0];
    stream_checks #(
        .Order(1 - Law),
        .Law(Law),
        .Progress(0)
    ) checks (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i && has),
        .in_ready_i(in_ready),
        .in_i(in_i.tag[1]),
        .out_valid_i(Law == 1 ? photon_valid : photon_valid && photon.last),
        .out_ready_i(photon_ready_i),
        .out_i(photon.tag)
    );
    (* hierconn *) logic [1:0] \checks.sent_q , \checks.taken_q ;
    if (Lemmas == 1) begin : gen_lemmas
      pair_inside #(
          .Places(Dealt + Owing + 4)
      ) pair (
          .rst_i(rst_i),
          .sent_i(\checks.sent_q ),
          .taken_i(\checks.taken_q ),
          .valid_i({
            !in_ready && spare_wants && spare_in.position[0],
            \dut.query_valid && dealing_wants && dealing.position[0],
            \dealt.valid_q & dealt_wants & dealt_has,
            \owing.valid_q ,
            leaving_valid & leaving_last
          }),
          .words_i({spare_in.tag[1], dealing.tag[1], dealt_photon_tag, owing_tag, leaving_tag})
      );
    end
    always_comb begin
      if (!rst_i && photon_valid) assert (photon.last == second_q && (!second_q || photon.tag == tag_q));
    end
  end
endmodule
