// SPDX-License-Identifier: Apache-2.0
// sources: tests/formal/harness/stubs/block_ram.sv rtl/common/lut_ram.sv rtl/reorder_buffer/pool_ram.sv
// pool_ram: a word, any, that is read is there two cycles later as it was last written, but for one that is written
// in the cycle in which it is read. Of each block RAM in it the one word is kept; of a rest in LUT RAM all are. Depths: 520, the rest in
// LUT RAM; 600, in block RAM; 8, no rest.
module pool_ram_word #(
    parameter int unsigned Depth = 520
) (
    input logic clk_i,
    input logic write_i,
    input logic [9:0] write_address_i,
    input logic write_data_i,
    input logic [9:0] read_address_i
);
  (* anyconst *) logic [9:0] watched;
  logic data;
  pool_ram #(
      .Width(1),
      .Depth(Depth)
  ) dut (
      .clk_i(clk_i),
      .write_i(write_i),
      .write_address_i(write_address_i),
      .write_data_i(write_data_i),
      .read_address_i(read_address_i),
      .read_data_o(data)
  );
  // Probes: the words that the block RAMs keep; each where the depth has that RAM, else they are any.
  (* keep *) logic [8:0] main_watched;
  (* keep *) logic [6:0] rest_watched;
  (* keep *) logic [2:0] all_watched;
  always_comb begin
    assume (watched < 10'(Depth) && write_address_i < 10'(Depth) && read_address_i < 10'(Depth));
    if (Depth < 512) assume (all_watched == watched[2:0]);
    else if (watched < 10'd512) assume (main_watched == watched[8:0]);
    else if (Depth > 576) assume (rest_watched == watched[6:0]);
  end

  logic written_q = 1'b0;
  logic [1:0] due_q = '0;
  logic word_q;  // as last written
  logic [1:0] words_q;  // as it was to be read
  logic writes;
  assign writes = write_i && write_address_i == watched;
  always_ff @(posedge clk_i) begin
    if (writes) word_q <= write_data_i;
    written_q <= written_q || writes;
    due_q <= {due_q[0], written_q && read_address_i == watched && !writes};
    words_q <= {words_q[0], word_q};
  end
  always_comb if (due_q[1]) assert (data == words_q[1]);
endmodule
