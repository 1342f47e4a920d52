// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/block_ram.sv rtl/common/block_ram_two_reads.sv rtl/photon_gatherer/photon_gatherer_node_memory.sv
// sources: rtl/photon_gatherer/photon_gatherer_registers.sv rtl/board/gather_nodes.sv
// gather_nodes: one node, any, is followed. Where it was written, and no node is meanwhile, each reader has its axis and split in the
// cycle after its address, whatever the others read. Words of the registers change none.
module gather_nodes_words #(
    parameter int unsigned Readers = 3
) (
    input logic clk_i,
    input logic rst_i,
    input logic cfg_valid_i,
    input logic [23:0] cfg_addr_i,
    input logic [63:0] cfg_data_i,
    input logic [2*Readers-1:0] read_address_i
);
  (* anyconst *) logic [1:0] followed;
  logic [4*Readers-1:0] read_data;

  gather_nodes #(
      .Readers(Readers)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .read_address_i(read_address_i),
      .read_data_o(read_data)
  );

  logic started_q = 1'b0;
  logic known_q, wrote_q;
  logic [3:0] word_q;
  logic [Readers-1:0] reads_q;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    wrote_q <= cfg_valid_i && !cfg_addr_i[23];
    for (int unsigned r = 0; r < Readers; r++) reads_q[r] <= read_address_i[2*r+:2] == followed;
    if (cfg_valid_i && !cfg_addr_i[23] && cfg_addr_i[1:0] == followed) begin
      known_q <= 1'b1;
      word_q  <= cfg_data_i[3:0];
    end
    if (rst_i) known_q <= 1'b0;
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i && known_q && !wrote_q)
      for (int unsigned r = 0; r < Readers; r++) if (reads_q[r]) assert (read_data[4*r+:4] == word_q);
  end
endmodule
