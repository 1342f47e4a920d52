// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/fifo.sv rtl/common/cache_lines.sv rtl/common/cache_victim.sv rtl/common/cache.sv
// cache: no request is lost. Whatever requests, lines and times came before, once no more come, answers are taken and memory
// sends a line a cycle while it owes one, each client that waits is answered within Limit cycles. A line is one part.
// Others 1: one client, either, is answered so though the other one asks on, whenever and for whatever it likes.
//
// What makes it hold in each cycle is asserted with it (Lemmas 1): a client that waits is in one place of the cache, an entry
// in use is in one of its states, and the entry to be used next is free.
module cache_answers #(
    parameter int unsigned Sets = 2,
    parameter int unsigned Ways = 2,
    parameter int unsigned Limit = 24,
    parameter int unsigned Others = 0,
    parameter int unsigned Lemmas = 0,
    parameter int unsigned Stage = 0,  // tags are compared in a stage of their own
    localparam int unsigned AddressBits = 2,
    localparam int unsigned Clients = 2,
    localparam int unsigned Misses = 2,
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned WayBits = Ways > 1 ? $clog2(Ways) : 1
) (
    input logic clk_i,
    input logic rst_i,
    input logic invalidate_i,
    input logic in_valid_i,
    input logic in_client_i,
    input logic [AddressBits-1:0] in_address_i,
    input logic ready_i,
    input logic line_req_ready_i,
    input logic line_rsp_valid_i,
    input logic line_rsp_tag_i,
    input logic [7:0] line_rsp_data_i
);
  (* anyconst *) logic [SetBits-1:0] set_mask;
  (* anyconst *) logic bypass;
  (* anyconst *) logic patient;  // the client that waits

  logic out_valid, out_client, line_req_valid, line_req_tag;

  cache #(
      .AddressBits(AddressBits),
      .Clients(Clients),
      .Items(1),
      .ItemBytes(1),
      .ItemBits(1),
      .Parts(1),
      .BeatBits(8),
      .Sets(Sets),
      .Ways(Ways),
      .Misses(Misses),
      .CompareStage(Stage != 0)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .invalidate_i(invalidate_i),
      .set_mask_i(set_mask),
      .bypass_i(bypass),
      .in_valid_i(in_valid_i),
      .in_client_i(in_client_i),
      .in_address_i(in_address_i),
      .ready_i(ready_i),
      .issue_o(),
      .out_valid_o(out_valid),
      .out_client_o(out_client),
      .out_part_o(),
      .out_data_o(),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready_i),
      .line_req_addr_o(),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(line_rsp_valid_i),
      .line_rsp_tag_i(line_rsp_tag_i),
      .line_rsp_data_i(line_rsp_data_i),
      .hit_o(),
      .miss_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Clients wait for their answers, tags for their lines. For quiet_q cycles no request came and nothing was held up.
  logic [Clients-1:0] waits_q;
  logic [Misses-1:0] asked_q;
  logic [5:0] quiet_q;
  logic quiet;
  assign quiet = (Others == 1 || (!in_valid_i && !invalidate_i)) && ready_i && line_req_ready_i && (line_rsp_valid_i || asked_q == '0);

  always_ff @(posedge clk_i) begin
    if (in_valid_i) waits_q[in_client_i] <= 1'b1;
    if (out_valid) waits_q[out_client] <= 1'b0;
    if (line_req_valid && line_req_ready_i) asked_q[line_req_tag] <= 1'b1;
    if (line_rsp_valid_i) asked_q[line_rsp_tag_i] <= 1'b0;
    quiet_q <= !quiet || (Others == 1 ? !waits_q[patient] : waits_q == '0) ? '0 : quiet_q + 1'b1;
    if (rst_i) begin
      waits_q <= '0;
      asked_q <= '0;
      quiet_q <= '0;
    end
  end

  // The environment: one request of a client at a time, lines that were asked for.
  always_comb begin
    if (Sets == 1) assume (set_mask == '0);
    if (!rst_i) begin
      if (in_valid_i) assume (!waits_q[in_client_i]);
      if (invalidate_i) assume (waits_q == '0 && !in_valid_i);
      if (line_rsp_valid_i) assume (asked_q[line_rsp_tag_i]);
    end
  end

  always_comb begin
    if (!rst_i) assert (quiet_q <= 6'(Limit));
  end

  // ---- inside ----
  (* hierconn *) logic \dut.valid_1_q , \dut.valid_2_q , \dut.valid_3_q , \dut.client_1_q , \dut.client_2_q , \dut.client_3_q ;
  (* hierconn *) logic \dut.valid_d , \dut.client_d , \dut.second_valid_q , \dut.second_client_q ;
  (* hierconn *) logic [1:0] \dut.again.head_q , \dut.again.tail_q ;
  (* hierconn *) logic \dut.hit_valid_q , \dut.hit_client_q , \dut.reader_valid_q , \dut.reader_client_q ;
  (* hierconn *) logic [Misses-1:0] \dut.busy_q , \dut.filled_q ;
  (* hierconn *) logic \dut.free_q , \dut.entry_q , \dut.lines.fill_q , \dut.fill_entry , \dut.lines.beat_q ;
  (* keep *) logic [AddressBits:0] again0, again1;  // client, address
  (* keep *) logic [SetBits+WayBits:0] serve0, serve1;  // place, client
  logic [1:0] again, again_here, serve_clients, again_clients;
  assign again = \dut.again.tail_q - \dut.again.head_q ;
  // Words of the queue that are in use.
  assign again_here = again == 2'd2 ? 2'b11 : again == 2'd1 ? 2'b01 << \dut.again.head_q [0] : 2'b00;
  assign again_clients = {again1[AddressBits], again0[AddressBits]};
  assign serve_clients = {serve1[0], serve0[0]};

  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (again <= 2'd2);
        for (int unsigned c = 0; c < Clients; c++) begin
          assert (4'(waits_q[c]) == 4'(\dut.valid_1_q && \dut.client_1_q == 1'(c)) +
              4'(\dut.valid_2_q && \dut.client_2_q == 1'(c)) + 4'(\dut.valid_3_q && \dut.client_3_q == 1'(c)) +
              4'(again_here[0] && again_clients[0] == 1'(c)) + 4'(again_here[1] && again_clients[1] == 1'(c)) +
              4'(\dut.hit_valid_q && \dut.hit_client_q == 1'(c)) +
              (Stage == 0 ? 4'd0 : 4'(\dut.valid_d && \dut.client_d == 1'(c)) +
               4'(\dut.second_valid_q && \dut.second_client_q == 1'(c))) +
              4'(\dut.busy_q [0] && serve_clients[0] == 1'(c)) + 4'(\dut.busy_q [1] && serve_clients[1] == 1'(c)) +
              4'(\dut.reader_valid_q && \dut.reader_client_q == 1'(c)) + 4'(out_valid && out_client == 1'(c)));
        end
        for (int unsigned m = 0; m < Misses; m++) begin
          assert (3'(\dut.busy_q [m]) == 3'(line_req_valid && line_req_tag == 1'(m)) + 3'(asked_q[m]) +
              3'(\dut.lines.fill_q && \dut.fill_entry == 1'(m)) + 3'(\dut.filled_q [m]));
        end
        assert (!\dut.free_q || line_req_valid || !\dut.busy_q [\dut.entry_q ]);
        assert (!\dut.lines.beat_q );
      end
    end
  end
endmodule
