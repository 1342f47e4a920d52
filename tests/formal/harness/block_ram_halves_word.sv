// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/block_ram.sv rtl/common/block_ram_halves.sv
// block_ram_halves: one word, any, is followed. What is at the output three cycles after its address began to stand for two is what
// was written there last, if it was not written meanwhile.
module block_ram_halves_word #(
    parameter int unsigned Width = 3
) (
    input logic clk_i,
    input logic rst_i,
    input logic write_i,
    input logic [1:0] write_address_i,
    input logic [Width-1:0] write_data_i,
    input logic [1:0] read_address_i
);
  (* anyconst *) logic [1:0] watched;
  logic [Width-1:0] read_data;

  block_ram_halves #(
      .Width(Width),
      .Depth(4)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .write_i(write_i),
      .write_address_i(write_address_i),
      .write_data_i(write_data_i),
      .read_address_i(read_address_i),
      .read_data_o(read_data)
  );

  logic started_q = 1'b0;
  logic known_q, wrote_q;
  logic [Width-1:0] word_q;
  logic [2:0] reads_q;  // of the last cycles
  logic [3:0] writes_q;
  logic mine;
  assign mine = write_i && write_address_i == watched;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    wrote_q <= write_i && !rst_i;
    reads_q <= rst_i ? '0 : {reads_q[1:0], read_address_i == watched};
    writes_q <= rst_i ? '0 : {writes_q[2:0], mine};
    if (mine) begin
      known_q <= 1'b1;
      word_q  <= write_data_i;
    end
    if (rst_i) known_q <= 1'b0;
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (write_i) assume (!wrote_q);
    // The two cycles in which its address stood, and the one before them, whose write has its second half in the first.
    if (!rst_i && known_q && reads_q[2:1] == 2'b11 && writes_q[3:1] == '0) assert (writes_q[0] || read_data == word_q);
  end
endmodule
