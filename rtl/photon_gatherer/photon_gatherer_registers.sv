// SPDX-License-Identifier: Apache-2.0
// Configuration of the photon gatherer, one write a cycle while no query is in flight: what cfg_* says of the maps and
// of the cache, and the writes that are for the node memory (docs/photon_gatherer.md has the address map). After reset
// the maps have no lines and the whole cache is in use; more is never. forget_o: any write makes the cache forget its
// lines.
//
// Registers show a write in the next cycle; writes of nodes and forget_o pass in their own cycle.
module photon_gatherer_registers #(
    parameter int unsigned Sets = 64,  // of the cache
    parameter int unsigned NodeAddressBits = 13,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned NodeBits = photonloom_pkg::LineBits + 1,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    input  logic                       cfg_valid_i,
    input  logic [               23:0] cfg_addr_i,
    input  logic [               63:0] cfg_data_i,
    // node memory
    output logic                       node_write_o,
    output logic [NodeAddressBits-1:0] node_address_o,
    output logic [   PositionBits+1:0] node_data_o,     // axis, split
    // maps: of the caustic, the global one
    output logic [     2*NodeBits-1:0] lines_o,
    output logic [       2*R2Bits-1:0] r2_max_o,
    // cache
    output logic                       forget_o,
    output logic [        SetBits-1:0] set_mask_o,
    output logic                       bypass_o
);
  /* verilator lint_off UNUSEDSIGNAL */  // not every address and data bit is used in every plan
  logic [23:0] address;
  logic [63:0] data;
  /* verilator lint_on UNUSEDSIGNAL */

  assign address = cfg_addr_i;
  assign data = cfg_data_i;
  assign node_write_o = cfg_valid_i && !address[23];
  assign node_address_o = address[NodeAddressBits-1:0];
  assign node_data_o = data[PositionBits+1:0];
  assign forget_o = cfg_valid_i;

  always_ff @(posedge clk_i) begin
    if (cfg_valid_i && address[23]) begin
      unique case (address[2:0])
        3'd0: lines_o[0+:NodeBits] <= data[NodeBits-1:0];
        3'd1: r2_max_o[0+:R2Bits] <= data[R2Bits-1:0];
        3'd2: lines_o[NodeBits+:NodeBits] <= data[NodeBits-1:0];
        3'd3: r2_max_o[R2Bits+:R2Bits] <= data[R2Bits-1:0];
        3'd4: {bypass_o, set_mask_o} <= {data[63], data[SetBits-1:0] & SetBits'(Sets - 1)};
        default: ;
      endcase
    end
    if (rst_i) begin
      lines_o <= '0;
      set_mask_o <= SetBits'(Sets - 1);
      bypass_o <= 1'b0;
    end
  end
endmodule
