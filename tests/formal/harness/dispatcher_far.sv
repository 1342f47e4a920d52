// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/narrow_far_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/fifo.sv rtl/common/skid_buffer.sv rtl/common/room_ahead.sv
// sources: rtl/common/word_sender.sv rtl/common/word_receiver.sv rtl/board/gather_dispatcher.sv
// sources: tests/formal/harness/dispatcher_model.sv tests/formal/harness/stream_checks.sv
// gather_dispatcher with two gatherers that lie far and take as long as they like: a query goes to one of them; results come out in
// the order of the queries, once and unchanged (Photons 0); photons come out query by query in that order, each query's together and
// whole (Photons 1). A query's lowest position bit says whether it has photons if it wants them.
module dispatcher_far #(
    parameter int unsigned Photons = 0,
    parameter bit TurnLater = 1'b0
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic result_ready_i,
    input logic photon_ready_i,
    input logic [5:0] idle_i
);
  localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits;
  logic in_ready, result_valid, photon_valid;
  photonloom_pkg::gather_result_t result;
  photonloom_pkg::gather_photon_t photon;
  logic [1:0] query_valid, query_ready, gatherer_result_valid, gatherer_result_ready, gatherer_photon_valid, gatherer_photon_ready;
  logic [3:0] gatherer_result, gatherer_photon;
  logic [2*QueryBits-1:0] queries;

  gather_dispatcher #(
      .Gatherers(2),
      .Pending(8),
      .TurnLater(TurnLater)
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
      .fetched_o(),
      .no_photons_o(),
      .fetched_result_o()
  );

  for (genvar g = 0; g < 2; g++) begin : gen_gatherer
    photonloom_pkg::gather_query_t query;
    assign query = queries[QueryBits*g+:QueryBits];
    dispatcher_model gatherer (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .idle_i(idle_i[3*g+:3]),
        .query_valid_i(query_valid[g]),
        .query_ready_o(query_ready[g]),
        .query_tag_i(query.tag),
        .query_wants_i(query.want_photons && !query.flush),
        .query_has_i(query.position[0]),
        .result_valid_o(gatherer_result_valid[g]),
        .result_ready_i(gatherer_result_ready[g]),
        .result_o(gatherer_result[2*g+:2]),
        .photon_valid_o(gatherer_photon_valid[g]),
        .photon_ready_i(gatherer_photon_ready[g]),
        .photon_o(gatherer_photon[2*g+:2])
    );
  end

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // A query goes to one gatherer.
  (* keep *) logic [1:0] deal;  // probe
  always_comb if (!rst_i) assert (deal != 2'b11);

  if (Photons == 0) begin : gen_results
    stream_checks #(
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
  end else begin : gen_photons
    logic second_q, tag_q;
    always_ff @(posedge clk_i) begin
      if (photon_valid && photon_ready_i) begin
        second_q <= !photon.last;
        tag_q <= photon.tag;
      end
      if (rst_i) second_q <= 1'b0;
    end
    always_comb if (!rst_i && photon_valid) assert (photon.last == second_q && (!second_q || photon.tag == tag_q));
    stream_checks #(
        .Law(0),
        .Progress(0)
    ) checks (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i && in_i.want_photons && !in_i.flush && in_i.position[0]),
        .in_ready_i(in_ready),
        .in_i(in_i.tag[1]),
        .out_valid_i(photon_valid && photon.last),
        .out_ready_i(photon_ready_i),
        .out_i(photon.tag)
    );
  end
endmodule
