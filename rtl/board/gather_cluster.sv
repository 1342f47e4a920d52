// SPDX-License-Identifier: Apache-2.0
// Gatherers photon gatherers behind one dispatcher: gather queries in, results and on request photons out, in the order of
// the queries. With reorder_i the queries pass the reorder buffer first, and results come in the order in which it lets
// them go (docs/reorder_buffer.md; only a flush empties it); reorder_i changes while nothing is inside.
//
// The packets are those of photon_gatherer, whatever Gatherers is. Configuration writes go to all gatherers, while nothing
// is inside. Line ports are the gatherers' own side by side, gatherer 0 lowest, and above them that of line_prefetcher, where there
// is one; for photon_ram or photon_sdram. With SharedNodes their node memories are gather_nodes', one for each two readers.
//
// Throughput: Gatherers times that of photon_gatherer until the line memory is busy; one query and one result a cycle at
// best. Latency: that of the gatherer and 7 cycles, and the reorder buffer's.
module gather_cluster #(
    parameter int unsigned Gatherers = photonloom_pkg::Gatherers,
    parameter int unsigned BeatBits = photonloom_pkg::LineBeatBits,
    localparam int unsigned Ahead = photonloom_pkg::PrefetchQueries,  // queries that line_prefetcher looks at ahead
    localparam int unsigned Ports = Gatherers + (Ahead != 0 ? 1 : 0),  // the prefetcher's is the highest
    localparam int unsigned TagBits = photonloom_pkg::LineTagBits,
    localparam int unsigned LineBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned ReplyBits = BeatBits + Parity
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    input  logic                              reorder_i,         // level: queries pass the reorder buffer
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
    // leaf lines; an address is {map, line}
    output logic [                 Ports-1:0] line_req_valid_o,
    input  logic [                 Ports-1:0] line_req_ready_i,
    output logic [    Ports*(LineBits+1)-1:0] line_req_addr_o,
    output logic [         Ports*TagBits-1:0] line_req_tag_o,
    input  logic [                 Ports-1:0] line_rsp_valid_i,
    input  logic [         Ports*TagBits-1:0] line_rsp_tag_i,
    /* verilator lint_off UNUSEDSIGNAL */  // what the prefetcher asked for is not looked at
    input  logic [       Ports*ReplyBits-1:0] line_rsp_data_i,
    /* verilator lint_on UNUSEDSIGNAL */
    // node memory and registers of every gatherer, written while nothing is inside
    input  logic                              cfg_valid_i,
    input  logic [                      23:0] cfg_addr_i,
    input  logic [                      63:0] cfg_data_i,
    output logic                              busy_o,            // a packet is inside, or waits at an output; or a line is fetched ahead
    // counted since reset
    output logic [                      39:0] count_busy_o,  // cycles with a packet inside or a line fetched ahead
    output logic [                      39:0] count_queries_o,  // results fetched, flushes apart
    output logic [                      39:0] count_nodes_o,  // inner nodes, of those
    output logic [                      39:0] count_leaves_o,  // leaves, of those
    output logic [                      39:0] count_insertions_o,  // candidates that entered a list, of those
    output logic [                      39:0] count_lines_o,  // lines requested
    output logic [                      39:0] count_stalled_in_o,  // cycles a query waited to be taken
    output logic [                      39:0] count_stalled_results_o,  // cycles a result waited to be taken
    output logic [                      39:0] count_stalled_photons_o,  // cycles a photon waited to be taken
    output logic [                      39:0] count_reordered_o,  // packets into the reorder buffer
    output logic [                      31:0] count_faults_o  // words of the gatherers' memories that were not right
);
  localparam int unsigned QueryBits = photonloom_pkg::GatherQueryPacketBits;
  localparam int unsigned ResultBits = photonloom_pkg::GatherResultPacketBits;
  localparam int unsigned PhotonBits = photonloom_pkg::GatherPhotonPacketBits;
  localparam bit OwnNodes = photonloom_pkg::SharedNodes == 0;
  localparam int unsigned NodeAddressBits = $clog2(photonloom_pkg::NodeWords);
  localparam int unsigned NodeDataBits = photonloom_pkg::PositionBits + 2 + Parity;

  // ---- order ----
  logic come_valid, come_ready, reorder_in_ready, reorder_out_valid, deal_valid, dealt_valid, deal_ready;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic prefetcher_ready, prefetcher_busy;  // where Ahead is not 0
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  photonloom_pkg::gather_query_t come, reorder_out, deal, dealt;
  logic cfg_valid_q;
  logic [23:0] cfg_addr_q;
  logic [63:0] cfg_data_q;

  /* verilator lint_off PINCONNECTEMPTY */  // counters that nobody reads are not built
  reorder_buffer reorder (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(come_valid && reorder_i),
      .in_ready_o(reorder_in_ready),
      .in_i(come),
      .out_valid_o(reorder_out_valid),
      .out_ready_i(reorder_i && (Ahead != 0 ? prefetcher_ready : deal_ready)),
      .out_o(reorder_out),
      .count_packets_o(),
      .count_flushes_o(),
      .count_cycles_busy_o(),
      .count_choice_waits_o()
  );
  assign come_ready = reorder_i ? reorder_in_ready : Ahead != 0 ? prefetcher_ready : deal_ready;
  assign deal_valid = reorder_i ? reorder_out_valid : come_valid;
  assign deal = reorder_i ? reorder_out : come;

  // Before an SDRAM a skid buffer, since the reorder buffer fills much of the part.
  if (photonloom_pkg::PhotonMemory != 0 && photonloom_pkg::FarGatherers != 0) begin : gen_incoming
    skid_buffer #(
        .Width(QueryBits)
    ) incoming (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(in_valid_i),
        .in_ready_o(in_ready_o),
        .in_i(in_i),
        .out_valid_o(come_valid),
        .out_ready_i(come_ready),
        .out_o(come)
    );
  end else begin : gen_straight
    assign come_valid = in_valid_i;
    assign in_ready_o = come_ready;
    assign come = in_i;
  end

  // ---- nodes ----
  logic [Ports*NodeAddressBits-1:0] node_address;
  /* verilator lint_off UNUSEDSIGNAL */  // the prefetcher looks at no parity bit
  logic [Ports*NodeDataBits-1:0] node_data;
  /* verilator lint_on UNUSEDSIGNAL */
  if (OwnNodes) begin : gen_own_nodes
    assign node_data = '0;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, node_address};
  end else begin : gen_shared_nodes
    gather_nodes #(
        .Readers(Ports)
    ) nodes (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .cfg_valid_i(cfg_valid_q),
        .cfg_addr_i(cfg_addr_q),
        .cfg_data_i(cfg_data_q),
        .read_address_i(node_address),
        .read_data_o(node_data)
    );
  end

  if (Ahead != 0) begin : gen_prefetcher
    line_prefetcher #(
        .Ahead(Ahead),
        .BeatBits(BeatBits),
        .OwnNodes(OwnNodes)
    ) prefetcher (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .cfg_valid_i(cfg_valid_q),
        .cfg_addr_i(cfg_addr_q),
        .cfg_data_i(cfg_data_q),
        .shared_node_address_o(node_address[NodeAddressBits*(Ports-1)+:NodeAddressBits]),
        .shared_node_data_i(node_data[NodeDataBits*(Ports-1)+:NodeDataBits-Parity]),
        .in_valid_i(deal_valid),
        .in_ready_o(prefetcher_ready),
        .in_i(deal),
        .out_valid_o(dealt_valid),
        .out_ready_i(deal_ready),
        .out_o(dealt),
        .line_req_valid_o(line_req_valid_o[Ports-1]),
        .line_req_ready_i(line_req_ready_i[Ports-1]),
        .line_req_addr_o(line_req_addr_o[(LineBits+1)*(Ports-1)+:LineBits+1]),
        .line_req_tag_o(line_req_tag_o[TagBits*(Ports-1)+:TagBits]),
        .line_rsp_valid_i(line_rsp_valid_i[Ports-1]),
        .line_rsp_tag_i(line_rsp_tag_i[TagBits*(Ports-1)+:TagBits]),
        .busy_o(prefetcher_busy)
    );
  end else begin : gen_no_prefetcher
    assign dealt_valid = deal_valid;
    assign dealt = deal;
  end

  // ---- gatherers ----
  logic [Gatherers-1:0] query_valid, query_ready, result_valid, result_ready, photon_valid, photon_ready;
  logic [Gatherers*QueryBits-1:0] queries;
  logic [Gatherers*ResultBits-1:0] results;
  logic [Gatherers*PhotonBits-1:0] photons;
  logic fetched, no_photons;
  logic [Gatherers*32-1:0] faults;
  /* verilator lint_off UNUSEDSIGNAL */  // its counts alone
  photonloom_pkg::gather_result_t fetched_result;
  /* verilator lint_on UNUSEDSIGNAL */

  gather_dispatcher #(
      .Gatherers(Gatherers)
  ) dispatcher (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(dealt_valid),
      .in_ready_o(deal_ready),
      .in_i(dealt),
      .result_valid_o(result_valid_o),
      .result_ready_i(result_ready_i),
      .result_o(result_o),
      .photon_valid_o(photon_valid_o),
      .photon_ready_i(photon_ready_i),
      .photon_o(photon_o),
      .query_valid_o(query_valid),
      .query_ready_i(query_ready),
      .query_o(queries),
      .result_valid_i(result_valid),
      .result_ready_o(result_ready),
      .result_i(results),
      .photon_valid_i(photon_valid),
      .photon_ready_o(photon_ready),
      .photon_i(photons),
      .fetched_o(fetched),
      .no_photons_o(no_photons),
      .fetched_result_o(fetched_result)
  );

  // A copy of the write port each cycle later: one net to all of them would be long.
  always_ff @(posedge clk_i) begin
    cfg_valid_q <= cfg_valid_i && !rst_i;
    cfg_addr_q <= cfg_addr_i;
    cfg_data_q <= cfg_data_i;
  end

  for (genvar g = 0; g < Gatherers; g++) begin : gen_gatherer
    photonloom_pkg::gather_result_t result;
    photonloom_pkg::gather_photon_t photon;
    assign results[ResultBits*g+:ResultBits] = result;
    assign photons[PhotonBits*g+:PhotonBits] = photon;

    photon_gatherer #(
        .LineBeatBits(BeatBits),
        .EarlyReplies(1'b0),
        .OwnNodes(OwnNodes)
    ) gatherer (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(query_valid[g]),
        .in_ready_o(query_ready[g]),
        .in_i(queries[QueryBits*g+:QueryBits]),
        .result_valid_o(result_valid[g]),
        .result_ready_i(result_ready[g]),
        .result_o(result),
        .photon_valid_o(photon_valid[g]),
        .photon_ready_i(photon_ready[g]),
        .photon_o(photon),
        .line_req_valid_o(line_req_valid_o[g]),
        .line_req_ready_i(line_req_ready_i[g]),
        .line_req_addr_o(line_req_addr_o[(LineBits+1)*g+:LineBits+1]),
        .line_req_tag_o(line_req_tag_o[TagBits*g+:TagBits]),
        .line_rsp_valid_i(line_rsp_valid_i[g]),
        .line_rsp_tag_i(line_rsp_tag_i[TagBits*g+:TagBits]),
        .line_rsp_data_i(line_rsp_data_i[ReplyBits*g+:ReplyBits]),
        .cfg_valid_i(cfg_valid_q),
        .cfg_addr_i(cfg_addr_q),
        .cfg_data_i(cfg_data_q),
        .shared_node_address_o(node_address[NodeAddressBits*g+:NodeAddressBits]),
        .shared_node_data_i(node_data[NodeDataBits*g+:NodeDataBits]),
        .count_busy_o(),
        .count_queries_o(),
        .count_nodes_o(),
        .count_dropped_o(),
        .count_leaves_o(),
        .count_candidates_o(),
        .count_insertions_o(),
        .count_cache_hits_o(),
        .count_cache_misses_o(),
        .count_stalled_in_o(),
        .count_stalled_results_o(),
        .count_stalled_photons_o(),
        .count_stalled_lines_o(),
        .count_faults_o(faults[32*g+:32])
    );
  end

  /* verilator lint_on PINCONNECTEMPTY */
  // ---- what is inside: queries without a result taken, and photons not taken ----
  localparam int unsigned InsideBits = 24;
  logic [InsideBits-1:0] inside_q, owed_q;
  logic photon_taken_last;
  assign photon_taken_last = photon_valid_o && photon_ready_i && photon_o.last;
  assign busy_o = inside_q != '0 || owed_q != '0 || (Ahead != 0 ? prefetcher_busy : 1'b0);

  always_ff @(posedge clk_i) begin
    inside_q <= inside_q + InsideBits'(in_valid_i && in_ready_o) - InsideBits'(result_valid_o && result_ready_i);
    // Counts down when a query that wants photons turns out to have none.
    owed_q <= owed_q + InsideBits'(in_valid_i && in_ready_o && in_i.want_photons && !in_i.flush) -
        InsideBits'(photon_taken_last) - InsideBits'(no_photons);
    if (rst_i) begin
      inside_q <= '0;
      owed_q <= '0;
    end
  end

  // ---- counters: each adds its step, a cycle later ----
  localparam int unsigned CounterCount = 10;
  localparam int unsigned LineSteps = $clog2(Gatherers + 1);
  localparam int unsigned StepBits = photonloom_pkg::IndexBits + 1 > LineSteps ? photonloom_pkg::IndexBits + 1 : LineSteps;
  logic [Gatherers-1:0] line_taken_q;
  logic [LineSteps-1:0] lines_taken;
  logic [CounterCount*StepBits-1:0] step_q;
  logic [CounterCount*40-1:0] count_q;
  logic counts;
  assign counts = fetched && !fetched_result.flush;
  always_comb begin
    lines_taken = '0;
    for (int unsigned g = 0; g < Gatherers; g++) lines_taken = lines_taken + LineSteps'(line_taken_q[g]);
  end

  always_ff @(posedge clk_i) begin
    line_taken_q <= Gatherers'(line_req_valid_o & line_req_ready_i);
    step_q <= {
      StepBits'(in_valid_i && in_ready_o && reorder_i),
      StepBits'(photon_valid_o && !photon_ready_i),
      StepBits'(result_valid_o && !result_ready_i),
      StepBits'(in_valid_i && !in_ready_o),
      StepBits'(lines_taken),
      counts ? StepBits'(fetched_result.insertions) : StepBits'(0),
      counts ? StepBits'(fetched_result.leaves) : StepBits'(0),
      counts ? StepBits'(fetched_result.nodes) : StepBits'(0),
      StepBits'(counts),
      StepBits'(busy_o)
    };
    for (int unsigned i = 0; i < CounterCount; i++)
      count_q[40*i+:40] <= count_q[40*i+:40] + 40'(step_q[StepBits*i+:StepBits]);
    if (rst_i) begin
      line_taken_q <= '0;
      step_q <= '0;
      count_q <= '0;
    end
  end
  if (Parity != 0) begin : gen_faults
    logic [31:0] sum;
    always_comb begin
      sum = '0;
      for (int unsigned g = 0; g < Gatherers; g++) sum = sum + faults[32*g+:32];
    end
    always_ff @(posedge clk_i) count_faults_o <= sum;
  end else begin : gen_no_faults
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, faults};
    assign count_faults_o = '0;
  end

  assign {
    count_reordered_o, count_stalled_photons_o, count_stalled_results_o, count_stalled_in_o, count_lines_o,
    count_insertions_o, count_leaves_o, count_nodes_o, count_queries_o, count_busy_o
  } = count_q;
endmodule
