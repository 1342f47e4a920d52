// SPDX-License-Identifier: Apache-2.0
// Plays the queries of its block RAM into the cluster as fast as it takes them, passes_i times the first queries_i of them,
// counts cycles and results and folds the results into a signature, so that the rate of a board is measured without its
// link. Queries are written word by word, the least significant word first, at {query, word}, while busy_o is 0.
//
// start_i takes queries_i, passes_i and mode_i; mode_i[0]: the cluster's reorder buffer is used (reorder_o), mode_i[1]:
// before the first query a write to node 0, which no map uses, makes all caches forget, and they are given time to.
// stop_i ends a replay early: no query follows but two at most that were read and, to empty the reorder buffer, a flush. want_photons is taken as 0.
// busy_o falls when nothing is inside any more. A query a cycle.
module query_replayer (
    input  logic                           clk_i,
    input  logic                           rst_i,
    // queries
    input  logic                           write_valid_i,
    input  logic [27:0]                    write_address_i,
    input  logic [31:0]                    write_word_i,
    // control
    input  logic                           start_i,
    input  logic                           stop_i,
    input  logic [31:0]                    queries_i,
    input  logic [31:0]                    passes_i,
    input  logic [ 1:0]                    mode_i,
    output logic                           busy_o,
    output logic                           reorder_o,
    output logic                           forget_o,          // one cycle: write anything to configuration address 0
    input  logic                           cluster_busy_i,
    // cluster
    output logic                           query_valid_o,
    input  logic                           query_ready_i,
    output photonloom_pkg::gather_query_t  query_o,
    input  logic                           result_valid_i,    // taken in every cycle
    input  photonloom_pkg::gather_result_t result_i,
    // since start_i
    output logic [47:0]                    cycles_o,
    output logic [63:0]                    signature_o,
    output logic [47:0]                    results_o
);
  localparam int unsigned Bits = photonloom_pkg::GatherQueryPacketBits;
  localparam int unsigned Words = (Bits + 31) / 32;
  localparam int unsigned WordBits = Words > 1 ? $clog2(Words) : 0;
  localparam int unsigned Depth = photonloom_pkg::ReplayQueries;
  localparam int unsigned AddressBits = $clog2(Depth);
  // Every set of a cache, and a few for the write's way there.
  localparam int unsigned ForgetCycles = photonloom_pkg::CacheBytes /
      (photonloom_pkg::Bucket * photonloom_pkg::PhotonBytes * photonloom_pkg::CacheWays) + 32;
  localparam int unsigned ForgetBits = $clog2(ForgetCycles + 1);

  typedef enum logic [2:0] {
    Idle,
    Forget,
    Play,
    Flush,  // stopped: the pipeline is emptied, then a flush offered
    Drain
  } state_t;
  state_t state_q;
  logic [ForgetBits-1:0] forget_left_q;
  logic [AddressBits-1:0] index_q, last_q;
  logic [31:0] passes_left_q;
  logic fetch, fetched_q, take, stopped_q, flushed_q, started_q, tick_q, quiet_q;
  logic [32*Words-1:0] fetched;
  photonloom_pkg::gather_query_t query_q;

  assign busy_o = state_q != Idle;
  assign take   = !query_valid_o || query_ready_i;
  assign fetch  = state_q == Play && !stopped_q && passes_left_q != '0 && (!fetched_q || take);

  for (genvar w = 0; w < Words; w++) begin : gen_words
    logic mine;
    assign mine = Words == 1 || (32'(write_address_i) & ((1 << WordBits) - 1)) == w;
    block_ram #(
        .Width(32),
        .Depth(Depth)
    ) store (
        .clk_i(clk_i),
        .write_i(write_valid_i && mine),
        .write_address_i(write_address_i[WordBits+:AddressBits]),
        .write_data_i(write_word_i),
        .read_i(fetch),
        .read_address_i(index_q),
        .read_data_o(fetched[32*w+:32])
    );
  end
  logic unused;
  assign unused = &{1'b0, write_address_i, fetched, queries_i};

  always_comb begin
    query_o = query_q;
    query_o.want_photons = 1'b0;
  end

  result_signature signature (
      .clk_i(clk_i),
      .clear_i(start_i),
      .in_valid_i(result_valid_i),
      .in_i(result_i),
      .signature_o(signature_o)
  );

  always_ff @(posedge clk_i) begin
    forget_o <= 1'b0;
    quiet_q  <= state_q == Drain && !fetched_q && !query_valid_o && !cluster_busy_i;
    tick_q   <= started_q && (state_q == Play || fetched_q || query_valid_o || cluster_busy_i);
    if (tick_q) cycles_o <= cycles_o + 48'd1;
    if (result_valid_i) results_o <= results_o + 48'd1;
    if (query_valid_o && query_ready_i) started_q <= 1'b1;
    if (stop_i && busy_o) stopped_q <= 1'b1;

    if (take) begin
      query_q <= fetched[Bits-1:0];
      query_valid_o <= fetched_q;
    end
    if (fetch) fetched_q <= 1'b1;
    else if (take) fetched_q <= 1'b0;
    if (fetch) begin
      index_q <= index_q == last_q ? '0 : index_q + 1'b1;
      if (index_q == last_q) passes_left_q <= passes_left_q - 32'd1;
    end

    unique case (state_q)
      Idle: begin
        index_q <= '0;
        last_q <= AddressBits'(queries_i - 32'd1);
        passes_left_q <= passes_i;
        forget_left_q <= ForgetBits'(ForgetCycles);
        if (start_i) begin
          reorder_o <= mode_i[0];
          forget_o  <= mode_i[1];
          state_q   <= mode_i[1] ? Forget : Play;
          started_q <= 1'b0;
          stopped_q <= 1'b0;
          cycles_o  <= '0;
          results_o <= '0;
        end
      end
      Forget: begin
        forget_left_q <= forget_left_q - 1'b1;
        if (forget_left_q == '0) state_q <= Play;
      end
      Play: begin
        if (stopped_q) state_q <= Flush;
        else if (passes_left_q == '0) state_q <= Drain;
      end
      Flush:
      if (take && !fetched_q) begin
        query_q <= '0;
        query_q.flush <= 1'b1;
        query_valid_o <= 1'b1;
        flushed_q <= 1'b1;
        state_q <= Drain;
      end
      default: begin
        if (stopped_q && !flushed_q) state_q <= Flush;
        else if (quiet_q) begin
          state_q   <= Idle;
          reorder_o <= 1'b0;
          flushed_q <= 1'b0;
        end
      end
    endcase
    if (rst_i) begin
      state_q <= Idle;
      reorder_o <= 1'b0;
      fetched_q <= 1'b0;
      query_valid_o <= 1'b0;
      stopped_q <= 1'b0;
      flushed_q <= 1'b0;
      started_q <= 1'b0;
      tick_q <= 1'b0;
      cycles_o <= '0;
      results_o <= '0;
    end
  end
endmodule
