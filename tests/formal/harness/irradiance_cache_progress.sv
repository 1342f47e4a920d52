// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/skid_buffer.sv rtl/common/fifo.sv rtl/common/counter.sv
// sources: rtl/common/less_than.sv rtl/common/multiplier.sv rtl/common/squared_distance.sv
// sources: rtl/irradiance_cache/irradiance_weight.sv rtl/irradiance_cache/irradiance_list.sv
// sources: rtl/irradiance_cache/irradiance_cache.sv
// irradiance_cache, whole, at its ports: as many answers come out as lookups went in. While some lookup has no answer yet one
// is offered within Limit cycles, whoever takes it and whenever; while none has, none is offered and a lookup is accepted.
//
// What makes it hold in each cycle is asserted with it (Lemmas 1): where the lookups inside are, and that the one that waits
// for its answer is in one stage of the arithmetic and has its place.
module irradiance_cache_progress #(
    parameter int unsigned Limit = 20,
    parameter int unsigned Lemmas = 0
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::cache_lookup_t in_i,
    input logic out_ready_i
);
  logic in_ready, out_valid;
  irradiance_cache dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(),
      .count_lookups_o(),
      .count_hits_o(),
      .count_records_made_o(),
      .count_full_o(),
      .count_records_read_o(),
      .count_cycles_busy_o(),
      .count_cycles_waiting_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Lookups that went in and have not been answered, cycles in which there were some and no answer was offered.
  logic [2:0] inside_q;
  logic [4:0] waited_q;
  always_ff @(posedge clk_i) begin
    inside_q <= inside_q + 3'(in_valid_i && in_ready) - 3'(out_valid && out_ready_i);
    waited_q <= inside_q != '0 && !out_valid ? waited_q + 1'b1 : '0;
    if (rst_i) begin
      inside_q <= '0;
      waited_q <= '0;
    end
  end

  always_comb begin
    if (!rst_i) begin
      assert (waited_q <= 5'(Limit));
      assert (inside_q != 3'd7);  // so it does not wrap
      if (inside_q == '0) assert (!out_valid && in_ready);
    end
  end

  // ---- inside ----
  (* hierconn *) logic \dut.incoming.main_valid_q , \dut.incoming.spare_valid_q ;
  (* hierconn *) logic \dut.scan_valid_q , \dut.drain_valid_q , \dut.decide_q ;
  (* hierconn *) logic [12:0] \dut.end_q ;
  (* hierconn *) logic [1:0] \dut.outgoing.head_q , \dut.outgoing.tail_q ;
  logic [1:0] answers;
  logic [13:0] stages;
  assign answers = \dut.outgoing.tail_q - \dut.outgoing.head_q ;
  assign stages  = {\dut.decide_q , \dut.end_q };

  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (inside_q == 3'(\dut.incoming.main_valid_q ) + 3'(\dut.incoming.spare_valid_q ) +
            3'(\dut.scan_valid_q ) + 3'(\dut.drain_valid_q ) + 3'(answers));
        assert (\dut.incoming.main_valid_q || !\dut.incoming.spare_valid_q );
        assert (\dut.drain_valid_q == (stages != '0));
        assert ((stages & (stages - 1'b1)) == '0);
        assert (answers + 2'(\dut.drain_valid_q ) <= 2'd2);
      end
    end
  end
endmodule
