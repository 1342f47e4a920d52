// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/reorder_buffer/pool_ram.sv rtl/reorder_buffer/free_list.sv
// free_list: one number, any, is never handed out while it is out. The owner has at most Count - 4 numbers out, and gives
// back the watched number only while it is out; of others it may give back any.
module free_list_numbers #(
    parameter int unsigned Count = 6
) (
    input logic clk_i,
    input logic rst_i,
    input logic take_i,
    input logic give_i,
    input logic [2:0] number_i
);
  (* anyconst *) logic [2:0] watched;
  logic [2:0] number;

  free_list #(
      .Count(Count)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .take_i(take_i),
      .number_o(number),
      .give_i(give_i),
      .number_i(number_i)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Numbers handed out two cycles after they were asked for.
  logic [1:0] taking_q;
  logic out_q;  // the watched number is
  logic [2:0] claimed_q;  // out or asked for
  always_ff @(posedge clk_i) begin
    taking_q  <= {taking_q[0], take_i};
    claimed_q <= claimed_q + 3'(take_i) - 3'(give_i);
    if (give_i && number_i == watched) out_q <= 1'b0;
    if (taking_q[1] && number == watched) out_q <= 1'b1;
    if (rst_i) begin
      taking_q <= '0;
      claimed_q <= '0;
      out_q <= 1'b0;
    end
  end

  always_comb begin
    assume (watched < Count && number_i < Count);
    if (!rst_i && take_i) assume (claimed_q < 3'(Count - 4));
    if (!rst_i && give_i) assume (claimed_q != '0 && (number_i != watched || out_q));
    if (!rst_i && taking_q[1]) assert (number < Count && !(number == watched && out_q));
  end
endmodule
