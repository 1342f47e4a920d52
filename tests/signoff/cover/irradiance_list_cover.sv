// SPDX-License-Identifier: Apache-2.0
module irradiance_list_cover #(
    parameter int unsigned Hits,
    parameter int unsigned Width,
    parameter int unsigned CountBits
) (
    input logic clk_i,
    input logic clear_i,
    input logic [Width-1:0] weight_i,
    input logic [CountBits-1:0] count_o,
    input logic [Hits*Width-1:0] weights_o,
    input logic [Hits-1:0] less
);
  logic full, tie;
  assign full = !clear_i && count_o == CountBits'(Hits);
  always_comb begin
    tie = 1'b0;
    for (int unsigned i = 0; i < Hits; i++) if (weights_o[Width*i+:Width] == weight_i) tie = 1'b1;
  end

  // Of equal weights the earlier record goes first: the new one stands behind.
  equal_weights: cover property (@(posedge clk_i) !clear_i && weight_i != '0 && tie);
  // A heavier record pushes the lightest one out of a full list.
  pushes_out: cover property (@(posedge clk_i) full && weight_i != '0 && less[Hits-1]);
  // A full list turns a lighter record down.
  turned_down: cover property (@(posedge clk_i) full && weight_i != '0 && !less[Hits-1]);
  // A new heaviest moves all others by a place.
  heaviest_of_many: cover property (@(posedge clk_i) !clear_i && count_o > CountBits'(1) && less[0]);
  // A record in the very cycle in which the list is emptied: it alone is left.
  first_as_cleared: cover property (@(posedge clk_i) clear_i && weight_i != '0);
endmodule
