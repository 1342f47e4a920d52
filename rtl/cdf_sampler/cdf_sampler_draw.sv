// SPDX-License-Identifier: Apache-2.0
// Samples from two tables: requests wait until their table is finished, then one a cycle goes through the search and
// out, in order. A table's prefix sums are written into the search while it is built; its total, pixel and sample
// number stand until nothing is owed from it, which owing_o says. Mirrors sample_cell and sample_direction of
// golden/unit/cdf_sampler.*: t = (u W) >> UBits, the cell that holds t, and the weight of it.
//
// Throughput one sample a cycle, latency 4 * CellBits + 6 from the waiting request to the sample. A request is let go when
// there is room for its sample (a credit), so nothing between stalls.
module cdf_sampler_draw #(
    parameter int unsigned CellBits = 5,
    parameter int unsigned ProbabilityBits = 16,
    parameter int unsigned UBits = 16,
    parameter int unsigned VBits = 8,
    parameter int unsigned RequestDepth = 64,  // a power of two
    localparam int unsigned IndexBits = 2 * CellBits,
    localparam int unsigned TotalBits = ProbabilityBits + IndexBits,
    localparam int unsigned PixelBits = photonloom_pkg::PixelBits,
    localparam int unsigned SampleBits = photonloom_pkg::SampleBits,
    localparam int unsigned TagBits = photonloom_pkg::TagBits
) (
    input  logic                    clk_i,
    input  logic                    rst_i,
    // requests
    input  logic                    in_valid_i,
    output logic                    in_ready_o,
    input  logic                    in_table_i,
    input  logic [       UBits-1:0] in_u_i,
    input  logic [     TagBits-1:0] in_tag_i,
    input  logic [     2*VBits-1:0] in_v_i,
    // the table being built: the sum of all weights before a cell
    input  logic                    write_i,
    input  logic                    write_table_i,
    input  logic [   IndexBits-1:0] write_cell_i,
    input  logic [   TotalBits-1:0] write_prefix_i,
    // both tables
    input  logic [             1:0] finished_i,
    input  logic [ 2*TotalBits-1:0] totals_i,
    input  logic [ 2*PixelBits-1:0] pixels_i,
    input  logic [2*SampleBits-1:0] samples_i,
    output logic [             1:0] owing_o,         // samples are still owed from this table
    // samples
    output logic                    out_valid_o,
    input  logic                    out_ready_i,
    output photonloom_pkg::sample_t out_o
);
  localparam int unsigned SideBits = 1 + TagBits + 2 * VBits;
  logic head_valid, issue, head_table;
  logic [UBits-1:0] head_u;
  logic [SideBits-1:0] head_side;
  fifo #(
      .Width(UBits + SideBits),
      .Depth(RequestDepth)
  ) requests (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i({in_u_i, in_table_i, in_tag_i, in_v_i}),
      .out_valid_o(head_valid),
      .out_ready_i(issue),
      .out_o({head_u, head_side})
  );
  assign head_table = head_side[SideBits-1];

  // A request goes on its way when there will be room for its sample.
  localparam int unsigned SearchLatency = 2 * IndexBits + 1;
  localparam int unsigned Latency = 1 + 3 + SearchLatency;  // from issue to the search's result
  localparam int unsigned OutDepth = 1 << $clog2(Latency + 4);
  localparam int unsigned CreditBits = $clog2(OutDepth + 1);
  logic [CreditBits-1:0] credit_q;
  logic [Latency:1] under_way_q;
  logic out_taken, out_ready;
  assign out_taken = out_valid_o && out_ready_i;
  assign issue = head_valid && finished_i[head_table] && credit_q != '0;

  // t = (u W) >> UBits.
  logic [UBits-1:0] u1_q;
  logic [TotalBits-1:0] total1_q, t, total4;
  logic [UBits+TotalBits-1:0] u_product;
  logic [3:0] tables_q;
  always_ff @(posedge clk_i) begin
    u1_q <= head_u;
    total1_q <= head_table ? totals_i[TotalBits+:TotalBits] : totals_i[0+:TotalBits];
    tables_q <= {tables_q[2:0], head_table};
    under_way_q <= {under_way_q[Latency-1:1], issue};
    if (issue && !out_taken) credit_q <= credit_q - 1'b1;
    else if (!issue && out_taken) credit_q <= credit_q + 1'b1;
    if (rst_i) begin
      under_way_q <= '0;
      credit_q <= CreditBits'(OutDepth);
    end
  end
  multiplier #(
      .ABits(UBits),
      .BBits(TotalBits)
  ) u_times_total (
      .clk_i(clk_i),
      .a_i(u1_q),
      .b_i(total1_q),
      .product_o(u_product)
  );
  assign t = u_product[UBits+:TotalBits];
  assign total4 = tables_q[3] ? totals_i[TotalBits+:TotalBits] : totals_i[0+:TotalBits];
  logic unused_product;
  assign unused_product = &{1'b0, u_product[UBits-1:0]};

  logic [IndexBits-1:0] found_cell;
  logic [TotalBits-1:0] found_weight;
  cdf_sampler_search #(
      .IndexBits(IndexBits),
      .TotalBits(TotalBits)
  ) search (
      .clk_i(clk_i),
      .write_i(write_i),
      .write_table_i(write_table_i),
      .write_cell_i(write_cell_i),
      .write_prefix_i(write_prefix_i),
      .table_i(tables_q[3]),
      .t_i(t),
      .total_i(total4),
      .cell_o(found_cell),
      .weight_o(found_weight)
  );
  logic unused_weight;
  assign unused_weight = &{1'b0, found_weight[TotalBits-1:ProbabilityBits]};

  // What a request carries waits beside the search, from the cycle after its issue.
  logic [SideBits-1:0] side1_q;
  always_ff @(posedge clk_i) side1_q <= head_side;
  logic side_ready, side_valid, side_table;
  logic [TagBits-1:0] side_tag;
  logic [2*VBits-1:0] side_v;
  logic found;
  assign found = under_way_q[Latency];
  fifo #(
      .Width(SideBits),
      .Depth(OutDepth)
  ) sides (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(under_way_q[1]),
      .in_ready_o(side_ready),
      .in_i(side1_q),
      .out_valid_o(side_valid),
      .out_ready_i(found),
      .out_o({side_table, side_tag, side_v})
  );

  photonloom_pkg::sample_t sample;
  always_comb begin
    sample.pixel = side_table ? pixels_i[PixelBits+:PixelBits] : pixels_i[0+:PixelBits];
    sample.sample = side_table ? samples_i[SampleBits+:SampleBits] : samples_i[0+:SampleBits];
    sample.tag = side_tag;
    sample.direction = {found_cell[CellBits+:CellBits], side_v[VBits+:VBits], found_cell[0+:CellBits], side_v[0+:VBits]};
    sample.cell_index = found_cell;
    sample.weight = found_weight[ProbabilityBits-1:0];
    sample.total = side_table ? totals_i[TotalBits+:TotalBits] : totals_i[0+:TotalBits];
  end
  fifo #(
      .Width(photonloom_pkg::SamplePacketBits),
      .Depth(OutDepth)
  ) outgoing (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(found),
      .in_ready_o(out_ready),
      .in_i(sample),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o(out_o)
  );

  // Samples owed by each table, from the request's arrival until its sample is complete.
  localparam int unsigned OwedBits = $clog2(RequestDepth + OutDepth + 1);
  for (genvar i = 0; i < 2; i++) begin : gen_owed
    logic [OwedBits-1:0] owed_q;
    logic more, less;
    assign more = in_valid_i && in_ready_o && in_table_i == 1'(i);
    assign less = found && side_table == 1'(i);
    always_ff @(posedge clk_i) begin
      owed_q <= owed_q + OwedBits'(more) - OwedBits'(less);
      if (rst_i) owed_q <= '0;
    end
    assign owing_o[i] = owed_q != '0;
  end

  // The FIFOs beside the pipeline have a place for each credit.
`ifdef SYNTHESIS
  logic unused_checks;
  assign unused_checks = &{1'b0, side_ready, side_valid, out_ready};
`else
  always_ff @(posedge clk_i) begin
    if (!rst_i) assert (!under_way_q[1] || side_ready);
    if (!rst_i) assert (!found || (side_valid && out_ready));
  end
`endif
endmodule
