// SPDX-License-Identifier: Apache-2.0
// The heaviest records of a lookup, by weight, of equal ones the earlier first. A record a cycle; a weight of 0 is none
// and stands behind the last. Latency 1.
module irradiance_list #(
    parameter int unsigned Hits = photonloom_pkg::CacheHits,
    parameter int unsigned RecordBits = photonloom_pkg::CacheRecordBits,
    parameter int unsigned WeightBits = photonloom_pkg::CacheWeightBits,
    parameter int unsigned CountBits = photonloom_pkg::CacheHitBits
) (
    input  logic                          clk_i,
    input  logic                          clear_i,  // the list is empty before what comes now
    input  logic [          WeightBits:0] weight_i,
    input  logic [        RecordBits-1:0] record_i,
    output logic [         CountBits-1:0] count_o,
    output logic [Hits*(WeightBits+1)-1:0] weights_o,
    output logic [   Hits*RecordBits-1:0] records_o
);
  localparam int unsigned Width = WeightBits + 1;

  // Where the new one stands: before the first lighter one.
  /* verilator lint_off UNUSEDSIGNAL */  // nothing stands behind the last
  logic [Hits-1:0] less;
  /* verilator lint_on UNUSEDSIGNAL */
  for (genvar i = 0; i < Hits; i++) begin : gen_entry
    logic [Width-1:0] weight, behind_weight;
    logic [RecordBits-1:0] behind_record;
    logic is_less, behind;
    assign weight = clear_i ? '0 : weights_o[Width*i+:Width];
    less_than #(
        .Width(Width)
    ) comparison (
        .a_i(weight),
        .b_i(weight_i),
        .less_o(is_less)
    );
    assign less[i] = is_less;
    if (i == 0) begin : gen_first
      assign behind = 1'b0;
      assign behind_weight = '0;
      assign behind_record = '0;
    end else begin : gen_others
      assign behind = less[i-1];
      assign behind_weight = clear_i ? '0 : weights_o[Width*(i-1)+:Width];
      assign behind_record = clear_i ? '0 : records_o[RecordBits*(i-1)+:RecordBits];
    end
    always_ff @(posedge clk_i) begin
      if (is_less || clear_i) begin
        weights_o[Width*i+:Width] <= !is_less ? '0 : behind ? behind_weight : weight_i;
        records_o[RecordBits*i+:RecordBits] <= !is_less ? '0 : behind ? behind_record : record_i;
      end
    end
  end

  always_ff @(posedge clk_i) begin
    if (clear_i) count_o <= CountBits'(weight_i != '0);
    else if (weight_i != '0 && count_o != CountBits'(Hits)) count_o <= count_o + 1'b1;
  end
endmodule
