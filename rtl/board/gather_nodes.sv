// SPDX-License-Identifier: Apache-2.0
// The inner nodes of both maps for all that read them in a cluster, its gatherers and its prefetcher: a memory for each two, on the two
// ports of its blocks, and one for the last where they are odd. A memory for each of two would mostly take twice the block RAM.
//
// Latency 1, each reader a word a cycle. cfg_*: as of photon_gatherer, written while nobody reads. The parity bit of a word, where
// the plan has one, is the highest and is not checked here.
module gather_nodes #(
    parameter int unsigned Readers = 2,
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned AddressBits = $clog2(photonloom_pkg::NodeWords),
    localparam int unsigned DataBits = photonloom_pkg::PositionBits + 2 + Parity  // axis, split
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           cfg_valid_i,
    input  logic [                   23:0] cfg_addr_i,
    input  logic [                   63:0] cfg_data_i,
    // of each reader, reader 0 lowest
    input  logic [Readers*AddressBits-1:0] read_address_i,
    output logic [   Readers*DataBits-1:0] read_data_o
);
  logic write;
  logic [AddressBits-1:0] write_address;
  logic [photonloom_pkg::PositionBits+1:0] node;
  logic [DataBits-1:0] word;
  /* verilator lint_off PINCONNECTEMPTY */
  photon_gatherer_registers #(
      .Sets(1),
      .NodeAddressBits(AddressBits)
  ) registers (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .node_write_o(write),
      .node_address_o(write_address),
      .node_data_o(node),
      .lines_o(),
      .r2_max_o(),
      .forget_o(),
      .set_mask_o(),
      .bypass_o()
  );
  /* verilator lint_on PINCONNECTEMPTY */

  if (Parity != 0) begin : gen_parity
    assign word = {^node, node};
  end else begin : gen_no_parity
    assign word = node;
  end

  for (genvar first = 0; first < Readers; first = first + 2) begin : gen_memory
    localparam int unsigned Here = Readers - first > 1 ? 2 : 1;
    photon_gatherer_node_memory #(
        .Trees(Here),
        .Width(DataBits),
        .Depth(photonloom_pkg::NodeWords)
    ) memory (
        .clk_i(clk_i),
        .write_i(write),
        .write_address_i(write_address),
        .write_data_i(word),
        .read_address_i(read_address_i[AddressBits*first+:Here*AddressBits]),
        .read_data_o(read_data_o[DataBits*first+:Here*DataBits])
    );
  end
endmodule
