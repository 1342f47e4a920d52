// SPDX-License-Identifier: Apache-2.0
// Photon lines in an SDR SDRAM, shared by Gatherers gatherers (and whatever else asks for lines, which counts as one) through one cache of whole lines in block RAM
// (docs/photon_memory.md). Global line l lies at byte l * stride, the caustic map's lines behind the global map's; stride is
// the power of two not under a line's bytes.
//
// Line ports are those of photon_gatherer, side by side, gatherer 0 lowest; a beat holds whole photons. A line from the cache
// comes 8 cycles after its request where nobody else asks, a beat a cycle. The SDRAM and its clock are behind sdram_lines.
//
// With photonloom_pkg::Parity the cache has parity, and a beat of a reply one bit more, the highest: it is not right, or the
// line asked for is beyond its map.
//
// forget_i (while no query is in flight) empties the cache. Words of 32 bits are written as into photon_ram; a line that the
// cache holds does not change by it, so forget_i comes after.
module photon_sdram #(
    parameter int unsigned Gatherers = photonloom_pkg::Gatherers,
    parameter int unsigned BeatBits = photonloom_pkg::LineBeatBits,
    parameter int unsigned CacheBytes = photonloom_pkg::BoardCacheBytes,
    parameter int unsigned CacheWays = 4,
    parameter int unsigned CacheMisses = 8,
    parameter int unsigned SdramKHz = photonloom_pkg::SdramKHz,  // frequency of clk_sdram_i at most
    localparam int unsigned TagBits = photonloom_pkg::LineTagBits,
    localparam int unsigned LineBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned ReplyBits = BeatBits + Parity
) (
    input  logic                              clk_i,
    input  logic                              rst_i,
    input  logic                              forget_i,
    input  logic [             Gatherers-1:0] line_req_valid_i,
    output logic [             Gatherers-1:0] line_req_ready_o,
    input  logic [Gatherers*(LineBits+1)-1:0] line_req_addr_i,
    input  logic [     Gatherers*TagBits-1:0] line_req_tag_i,
    output logic [             Gatherers-1:0] line_rsp_valid_o,
    output logic [     Gatherers*TagBits-1:0] line_rsp_tag_o,
    output logic [   Gatherers*ReplyBits-1:0] line_rsp_data_o,
    // words of the lines
    input  logic                              write_valid_i,
    output logic                              write_ready_o,
    input  logic [                      27:0] write_address_i,
    input  logic [                      31:0] write_data_i,
    output logic                              ready_o,          // the SDRAM is initialised
    // the chip, in the domain of clk_sdram_i
    input  logic                              clk_sdram_i,
    output logic                              sdram_cke_o,
    output logic                              sdram_cs_no,
    output logic                              sdram_ras_no,
    output logic                              sdram_cas_no,
    output logic                              sdram_we_no,
    output logic [                       1:0] sdram_ba_o,
    output logic [                      12:0] sdram_a_o,
    output logic [                       1:0] sdram_dqm_o,
    input  logic [                      15:0] sdram_dq_i,
    output logic [                      15:0] sdram_dq_o,
    output logic                              sdram_dq_oe_o,
    // counted since reset
    output logic [                      39:0] count_lines_o,    // lines read from the SDRAM
    output logic [                      39:0] count_busy_o,     // cycles with such a line on its way
    output logic [                      31:0] count_faults_o    // parts of lines and tags in the cache that were not right
);
  localparam int unsigned Bucket = photonloom_pkg::Bucket;
  // What is kept of a slot: a photon, or all of it where lines are compressed.
  localparam int unsigned KeptBits = photonloom_pkg::RecordBits + photonloom_pkg::SlotHeaderBits;
  localparam int unsigned StrideBits = 8 * photonloom_pkg::PhotonBytes;
  localparam int unsigned LineHalfwords = Bucket * StrideBits / 16;
  localparam int unsigned HalfwordBits = $clog2(LineHalfwords);
  localparam int unsigned LineWords = LineHalfwords / 2;
  localparam int unsigned WordBits = $clog2(LineWords);
  localparam int unsigned Beats = Bucket * StrideBits / BeatBits;
  localparam int unsigned BeatPhotons = Bucket / Beats;
  localparam int unsigned SourceBits = Gatherers > 1 ? $clog2(Gatherers) : 1;
  localparam int unsigned ClientBits = SourceBits + TagBits;
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalMemoryLines;
  localparam int unsigned CausticLines = photonloom_pkg::CausticMemoryLines;
  localparam int unsigned Lines = GlobalLines + CausticLines;

  // The largest power of two of sets that fits.
  localparam int unsigned SetsThatFit = CacheBytes / (Bucket * photonloom_pkg::PhotonBytes * CacheWays);
  localparam int unsigned Sets = SetsThatFit == 0 ? 0 : 1 << ($clog2(SetsThatFit + 1) - 1);
  localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1;
  localparam int unsigned MissBits = CacheMisses > 1 ? $clog2(CacheMisses) : 1;

  if (Sets == 0) begin : gen_bad_cache
    board_cache_bytes_must_hold_one_line_in_each_way bad_cache ();
  end
  if (Lines > (1 << (24 - HalfwordBits))) begin : gen_bad_lines
    photon_maps_must_fit_in_32_megabytes_of_sdram bad_lines ();
  end
  if (BeatBits * Beats != Bucket * StrideBits || Bucket % Beats != 0) begin : gen_bad_beat
    gatherer_beat_bits_must_be_whole_photons_and_divide_the_line bad_beat ();
  end

  logic rst, rst_sdram;
  reset_bridge reset (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .rst_o(rst),
      .other_clk_i(clk_sdram_i),
      .other_rst_o(rst_sdram)
  );

  // ---- gatherers to cache, which takes every request ----
  logic ask_valid;
  logic [LineBits+TagBits:0] ask;
  logic [SourceBits-1:0] ask_source;
  logic [Gatherers*(LineBits+1+TagBits)-1:0] req;

  for (genvar g = 0; g < Gatherers; g++) begin : gen_req
    assign req[(LineBits+1+TagBits)*g+:LineBits+1+TagBits] = {
      line_req_addr_i[(LineBits+1)*g+:LineBits+1], line_req_tag_i[TagBits*g+:TagBits]
    };
  end
  arbiter #(
      .Inputs(Gatherers),
      .Width(LineBits + 1 + TagBits)
  ) turns (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(line_req_valid_i),
      .in_ready_o(line_req_ready_o),
      .in_i(req),
      .out_valid_o(ask_valid),
      .out_ready_i(1'b1),
      .out_o(ask),
      .out_source_o(ask_source)
  );

  logic beat_valid, beat_wrong, tag_wrong;
  logic [ClientBits-1:0] beat_client;
  logic [BeatPhotons*KeptBits-1:0] beat_photons;
  logic line_req_valid, line_req_ready, line_rsp_valid;
  logic [LineBits:0] line_req_addr;
  logic [MissBits-1:0] line_req_tag, line_rsp_tag;
  logic [63:0] line_rsp_data;
  logic [63+Parity:0] line_rsp_word;

  cache #(
      .AddressBits(LineBits + 1),
      .Clients(1 << ClientBits),
      .Items(Bucket),
      .ItemBytes(photonloom_pkg::PhotonBytes),
      .ItemBits(KeptBits),
      .Parts(Beats),
      .BeatBits(64),
      .Parity(Parity),
      .Sets(Sets),
      .Ways(CacheWays),
      .Misses(CacheMisses),
      .CompareStage(1'b1)
  ) lines (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .invalidate_i(forget_i),
      .set_mask_i(SetBits'(Sets - 1)),
      .bypass_i(1'b0),
      .in_valid_i(ask_valid),
      .in_client_i({ask_source, ask[TagBits-1:0]}),
      .in_address_i(ask[LineBits+TagBits:TagBits]),
      .ready_i(1'b1),
      .out_valid_o(beat_valid),
      .out_client_o(beat_client),
      .out_data_o(beat_photons),
      .out_wrong_o(beat_wrong),
      .line_req_valid_o(line_req_valid),
      .line_req_ready_i(line_req_ready),
      .line_req_addr_o(line_req_addr),
      .line_req_tag_o(line_req_tag),
      .line_rsp_valid_i(line_rsp_valid),
      .line_rsp_tag_i(line_rsp_tag),
      .line_rsp_data_i(line_rsp_word),
      .tag_wrong_o(tag_wrong),
      /* verilator lint_off PINCONNECTEMPTY */
      .issue_o(),
      .out_part_o(),
      .out_header_o(),
      .hit_o(),
      .miss_o()
      /* verilator lint_on PINCONNECTEMPTY */
  );

  // ---- lines beyond their map ----
  // The chip has something at every address; what is written of them into the cache is told to be wrong.
  if (Parity != 0) begin : gen_parity
    logic [(1<<MissBits)-1:0] beyond_q;
    always_ff @(posedge clk_i) begin
      if (line_req_valid)
        beyond_q[line_req_tag] <= 32'(line_req_addr[LineBits-1:0]) >= (line_req_addr[LineBits] ? CausticLines : GlobalLines);
      count_faults_o <= count_faults_o + 32'(beat_wrong) + 32'(tag_wrong);
      if (rst) count_faults_o <= '0;
    end
    assign line_rsp_word = {beyond_q[line_rsp_tag], line_rsp_data};
  end else begin : gen_no_parity
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, beat_wrong, tag_wrong};
    assign line_rsp_word = line_rsp_data;
    assign count_faults_o = '0;
  end

  // ---- a beat to its gatherer ----
  // It leaves a cycle after it came, when it is known whether it is right.
  logic beat_valid_q;
  logic [ClientBits-1:0] beat_client_q;
  logic [BeatPhotons*KeptBits-1:0] beat_photons_q;
  logic [BeatBits-1:0] beat_raw;

  always_ff @(posedge clk_i) begin
    beat_valid_q <= beat_valid && !rst_i;
    beat_client_q <= beat_client;
    beat_photons_q <= beat_photons;
  end
  for (genvar photon = 0; photon < BeatPhotons; photon++) begin : gen_unpack
    assign beat_raw[StrideBits*photon+:StrideBits] = StrideBits'(beat_photons_q[KeptBits*photon+:KeptBits]);
  end
  for (genvar g = 0; g < Gatherers; g++) begin : gen_rsp
    assign line_rsp_valid_o[g] = beat_valid_q && beat_client_q[TagBits+:SourceBits] == SourceBits'(g);
    assign line_rsp_tag_o[TagBits*g+:TagBits] = beat_client_q[TagBits-1:0];
    assign line_rsp_data_o[ReplyBits*g+:BeatBits] = beat_raw;
    if (Parity != 0) begin : gen_wrong
      assign line_rsp_data_o[ReplyBits*g+ReplyBits-1] = beat_wrong;
    end
  end

  // ---- words to write ----
  logic write_valid, write_taken;
  logic [27:0] write_line;
  logic [WordBits-1:0] write_word;
  logic [31:0] write_data;

  photon_word_address #(
      .LineWords(LineWords)
  ) word_address (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(write_valid_i),
      .in_ready_o(write_ready_o),
      .in_address_i(write_address_i),
      .in_data_i(write_data_i),
      .out_valid_o(write_valid),
      .out_taken_i(write_taken),
      .out_line_o(write_line),
      .out_word_o(write_word),
      .out_data_o(write_data)
  );

  // ---- the SDRAM ----
  logic line_done, line_busy, write_inside;
  logic [23:0] line_address, write_address;

  assign write_inside = 32'(write_line) < Lines;
  assign write_address = 24'({write_line, HalfwordBits'({write_word, 1'b0})});
  assign line_address = 24'({24'(line_req_addr[LineBits-1:0]) + (line_req_addr[LineBits] ? 24'(GlobalLines) : 24'd0),
      HalfwordBits'(0)});

  sdram_lines #(
      .TagBits(MissBits),
      .LineHalfwords(LineHalfwords),
      .SdramKHz(SdramKHz),
      .RefreshesAhead(photonloom_pkg::RefreshesAhead)
  ) memory (
      .clk_i(clk_i),
      .rst_i(rst),
      .line_req_valid_i(line_req_valid),
      .line_req_ready_o(line_req_ready),
      .line_req_address_i(line_address),
      .line_req_tag_i(line_req_tag),
      .line_rsp_valid_o(line_rsp_valid),
      .line_rsp_tag_o(line_rsp_tag),
      .line_rsp_data_o(line_rsp_data),
      .write_valid_i(write_valid),
      .write_inside_i(write_inside),
      .write_taken_o(write_taken),
      .write_address_i(write_address),
      .write_data_i(write_data),
      .ready_o(ready_o),
      .done_o(line_done),
      .busy_o(line_busy),
      .clk_sdram_i(clk_sdram_i),
      .rst_sdram_i(rst_sdram),
      .sdram_cke_o(sdram_cke_o),
      .sdram_cs_no(sdram_cs_no),
      .sdram_ras_no(sdram_ras_no),
      .sdram_cas_no(sdram_cas_no),
      .sdram_we_no(sdram_we_no),
      .sdram_ba_o(sdram_ba_o),
      .sdram_a_o(sdram_a_o),
      .sdram_dqm_o(sdram_dqm_o),
      .sdram_dq_i(sdram_dq_i),
      .sdram_dq_o(sdram_dq_o),
      .sdram_dq_oe_o(sdram_dq_oe_o)
  );

  // ---- counters ----
  logic done_q, busy_q;
  always_ff @(posedge clk_i) begin
    done_q <= line_done;
    busy_q <= line_busy;
    count_lines_o <= count_lines_o + 40'(done_q);
    count_busy_o <= count_busy_o + 40'(busy_q);
    if (rst) begin
      done_q <= 1'b0;
      busy_q <= 1'b0;
      count_lines_o <= '0;
      count_busy_o <= '0;
    end
  end
endmodule
