// SPDX-License-Identifier: Apache-2.0
// A gather cluster and the photon memory of the plan, photon_ram or photon_sdram: everything that answers queries on a board.
// Queries in, results and photons out as gather_cluster's; maps come in by cfg_* (nodes and registers) and write_* (words of
// the lines), both while busy_o is 0; a word is in the memory when write_ready_o is 1 again, and no query comes before. Any cfg write makes all caches forget their lines.
//
// The SDRAM's pins are in the domain of clk_sdram_i, which may have any frequency and phase; without SDRAM they are idle
// and the clock is not used.
module gather_engine #(
    parameter int unsigned Gatherers = photonloom_pkg::Gatherers,
    parameter int unsigned PhotonMemory = photonloom_pkg::PhotonMemory  // 0 block RAM, 1 SDRAM
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           reorder_i,                // level: queries pass the reorder buffer
    // queries
    input  logic                           in_valid_i,
    output logic                           in_ready_o,
    input  photonloom_pkg::gather_query_t  in_i,
    // results
    output logic                           result_valid_o,
    input  logic                           result_ready_i,
    output photonloom_pkg::gather_result_t result_o,
    // photons
    output logic                           photon_valid_o,
    input  logic                           photon_ready_i,
    output photonloom_pkg::gather_photon_t photon_o,
    // maps
    input  logic                           cfg_valid_i,
    input  logic [                   23:0] cfg_addr_i,
    input  logic [                   63:0] cfg_data_i,
    input  logic                           write_valid_i,
    output logic                           write_ready_o,
    input  logic [                   27:0] write_address_i,
    input  logic [                   31:0] write_data_i,
    output logic                           memory_ready_o,  // lines can be read and written
    output logic                           busy_o,  // a packet is inside, or waits at an output, or a line is fetched ahead
    // SDRAM
    input  logic                           clk_sdram_i,
    output logic                           sdram_cke_o,
    output logic                           sdram_cs_no,
    output logic                           sdram_ras_no,
    output logic                           sdram_cas_no,
    output logic                           sdram_we_no,
    output logic [                    1:0] sdram_ba_o,
    output logic [                   12:0] sdram_a_o,
    output logic [                    1:0] sdram_dqm_o,
    input  logic [                   15:0] sdram_dq_i,
    output logic [                   15:0] sdram_dq_o,
    output logic                           sdram_dq_oe_o,
    // counted since reset; see gather_cluster
    output logic [                   39:0] count_busy_o,  // cycles with a packet inside or a line fetched ahead
    output logic [                   39:0] count_queries_o,  // results fetched, flushes apart
    output logic [                   39:0] count_nodes_o,  // inner nodes, of those
    output logic [                   39:0] count_leaves_o,  // leaves, of those
    output logic [                   39:0] count_insertions_o,  // candidates that entered a list, of those
    output logic [                   39:0] count_lines_o,  // lines requested by gatherers
    output logic [                   39:0] count_stalled_in_o,  // cycles a query waited to be taken
    output logic [                   39:0] count_stalled_results_o,  // cycles a result waited to be taken
    output logic [                   39:0] count_stalled_photons_o,  // cycles a photon waited to be taken
    output logic [                   39:0] count_reordered_o,  // packets into the reorder buffer
    output logic [                   39:0] count_memory_lines_o,  // lines that the photon memory read
    output logic [                   39:0] count_memory_busy_o,  // cycles in which it was reading
    output logic [                   31:0] count_faults_o  // words of memory that were not right; 0 without parity
);
  localparam int unsigned TagBits = photonloom_pkg::LineTagBits;
  localparam int unsigned BeatBits = photonloom_pkg::LineBeatBits;
  localparam int unsigned AddressBits = photonloom_pkg::LineAddressBits + 1;
  localparam int unsigned ReplyBits = BeatBits + photonloom_pkg::Parity;

  localparam int unsigned Ports = Gatherers + (photonloom_pkg::PrefetchQueries != 0 ? 1 : 0);
  logic [Ports-1:0] line_req_valid, line_req_ready, line_rsp_valid;
  logic [Ports*AddressBits-1:0] line_req_addr;
  logic [Ports*TagBits-1:0] line_req_tag, line_rsp_tag;
  logic [Ports*ReplyBits-1:0] line_rsp_data;
  logic [31:0] cluster_faults, memory_faults;
  assign count_faults_o = cluster_faults + memory_faults;

  gather_cluster #(
      .Gatherers(Gatherers),
      .BeatBits(BeatBits)
  ) cluster (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .reorder_i(reorder_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .result_valid_o(result_valid_o),
      .result_ready_i(result_ready_i),
      .result_o(result_o),
      .photon_valid_o(photon_valid_o),
      .photon_ready_i(photon_ready_i),
      .photon_o(photon_o),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready),
      .line_req_addr_o(line_req_addr),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(line_rsp_valid),
      .line_rsp_tag_i(line_rsp_tag),
      .line_rsp_data_i(line_rsp_data),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .busy_o(busy_o),
      .count_busy_o(count_busy_o),
      .count_queries_o(count_queries_o),
      .count_nodes_o(count_nodes_o),
      .count_leaves_o(count_leaves_o),
      .count_insertions_o(count_insertions_o),
      .count_lines_o(count_lines_o),
      .count_stalled_in_o(count_stalled_in_o),
      .count_stalled_results_o(count_stalled_results_o),
      .count_stalled_photons_o(count_stalled_photons_o),
      .count_reordered_o(count_reordered_o),
      .count_faults_o(cluster_faults)
  );

  if (PhotonMemory == 0) begin : gen_ram
    /* verilator lint_off UNUSEDSIGNAL */
    logic [16:0] unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = {clk_sdram_i, sdram_dq_i};
    assign sdram_cke_o = 1'b0;
    assign {sdram_cs_no, sdram_ras_no, sdram_cas_no, sdram_we_no} = '1;
    assign sdram_ba_o = '0;
    assign sdram_a_o = '0;
    assign sdram_dqm_o = '1;
    assign sdram_dq_o = '0;
    assign sdram_dq_oe_o = 1'b0;

    photon_ram #(
        .Gatherers(Ports),
        .BeatBits(BeatBits)
    ) memory (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .line_req_valid_i(line_req_valid),
        .line_req_ready_o(line_req_ready),
        .line_req_addr_i(line_req_addr),
        .line_req_tag_i(line_req_tag),
        .line_rsp_valid_o(line_rsp_valid),
        .line_rsp_tag_o(line_rsp_tag),
        .line_rsp_data_o(line_rsp_data),
        .write_valid_i(write_valid_i),
        .write_ready_o(write_ready_o),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .ready_o(memory_ready_o),
        .count_lines_o(count_memory_lines_o),
        .count_busy_o(count_memory_busy_o),
        .count_faults_o(memory_faults)
    );
  end else begin : gen_sdram
    photon_sdram #(
        .Gatherers(Ports),
        .BeatBits(BeatBits)
    ) memory (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .forget_i(cfg_valid_i),
        .line_req_valid_i(line_req_valid),
        .line_req_ready_o(line_req_ready),
        .line_req_addr_i(line_req_addr),
        .line_req_tag_i(line_req_tag),
        .line_rsp_valid_o(line_rsp_valid),
        .line_rsp_tag_o(line_rsp_tag),
        .line_rsp_data_o(line_rsp_data),
        .write_valid_i(write_valid_i),
        .write_ready_o(write_ready_o),
        .write_address_i(write_address_i),
        .write_data_i(write_data_i),
        .ready_o(memory_ready_o),
        .clk_sdram_i(clk_sdram_i),
        .sdram_cke_o(sdram_cke_o),
        .sdram_cs_no(sdram_cs_no),
        .sdram_ras_no(sdram_ras_no),
        .sdram_cas_no(sdram_cas_no),
        .sdram_we_no(sdram_we_no),
        .sdram_ba_o(sdram_ba_o),
        .sdram_a_o(sdram_a_o),
        .sdram_dqm_o(sdram_dqm_o),
        .sdram_dq_i(sdram_dq_i),
        .sdram_dq_o(sdram_dq_o),
        .sdram_dq_oe_o(sdram_dq_oe_o),
        .count_lines_o(count_memory_lines_o),
        .count_busy_o(count_memory_busy_o),
        .count_faults_o(memory_faults)
    );
  end
endmodule
