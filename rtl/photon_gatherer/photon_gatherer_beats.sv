// SPDX-License-Identifier: Apache-2.0
// From a leaf to beats of candidates: its line comes through the cache, or where Sets is 0 straight from memory, Lanes
// photons a cycle, the lanes keep what lies within the bound of the query, and it waits for the query's list, each of which
// has a queue. Wires the cache, the lanes, the queues, and the positions and bounds of queries that the lanes read. List l
// has the contexts c with c % Lists = l, as c / Lists. A line is read when each queue has room for it. Compressed lines pass
// a decoder; a leaf's further lines are looked up when no leaf is reached.
//
// One leaf lookup and one beat a cycle, leaves in any order. Latency of a leaf in the cache 5 cycles to its first beat
// and 6 to the lanes' FIFO, 7 where lines are compressed.
module photon_gatherer_beats #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Lists = 1,
    parameter int unsigned Lanes = 4,
    parameter int unsigned Sets = 64,
    parameter int unsigned CacheWays = 2,
    parameter int unsigned CacheMisses = 8,
    parameter int unsigned LineBeatBits = 128,
    parameter int unsigned Behind = 16,  // beats that may be between a queue and its list
    parameter bit Wide = 1'b0,  // of several trees and lists
    parameter bit WriteAlways = Wide,  // rows are written before it is known whether a beat is kept, where they are few
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned AddressBits = photonloom_pkg::LineAddressBits,
    localparam int unsigned Bucket = photonloom_pkg::Bucket,
    localparam int unsigned DirectionBits = photonloom_pkg::DirectionBits,
    localparam int unsigned MantissasBits = photonloom_pkg::Channels * photonloom_pkg::MantissaBits,
    localparam int unsigned ExponentBits = photonloom_pkg::ExponentBits,
    localparam int unsigned LoadBits = 2 * DirectionBits + MantissasBits + ExponentBits,
    localparam int unsigned PhotonBits = 3 * PositionBits + LoadBits,
    localparam int unsigned Beats = Bucket / Lanes,
    localparam int unsigned BeatBits = Beats > 1 ? $clog2(Beats) : 1,
    localparam int unsigned RowBits = $clog2((2 * Beats > 16 ? 1 << $clog2(2 * Beats) : photonloom_pkg::QueuedBeats) + Behind),
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned TagBits = Sets == 0 ? ContextBits : CacheMisses > 1 ? $clog2(CacheMisses) : 1,
    localparam int unsigned Parity = photonloom_pkg::Parity
) (
    input  logic                                   clk_i,
    input  logic                                   rst_i,
    // configuration of the cache
    input  logic                                   forget_i,
    input  logic [                    SetBits-1:0] set_mask_i,
    input  logic                                   bypass_i,
    // a query starts
    input  logic                                   start_i,
    input  logic [                ContextBits-1:0] start_context_i,
    input  logic [             3*PositionBits-1:0] start_position_i,
    // a leaf is reached
    input  logic                                   leaf_valid_i,
    input  logic [                ContextBits-1:0] leaf_context_i,
    input  logic [                  AddressBits:0] leaf_address_i,    // map, line
    // the last part of a line goes to the lanes: whether its leaf has another one
    output logic                                   line_last_o,
    output logic [                ContextBits-1:0] line_context_o,
    output logic                                   line_more_o,
    output logic [                  AddressBits:0] line_next_o,
    // which is read
    input  logic                                   next_valid_i,
    output logic                                   next_ready_o,
    input  logic [                ContextBits-1:0] next_context_i,
    input  logic [                  AddressBits:0] next_address_i,
    // leaf lines
    output logic                                   line_req_valid_o,
    input  logic                                   line_req_ready_i,
    output logic [                  AddressBits:0] line_req_addr_o,
    output logic [                    TagBits-1:0] line_req_tag_o,
    input  logic                                   line_rsp_valid_i,
    input  logic [                    TagBits-1:0] line_rsp_tag_i,
    input  logic [        LineBeatBits+Parity-1:0] line_rsp_data_i,
    // a bound is written, by each list for its contexts
    input  logic [                      Lists-1:0] bound_write_i,
    input  logic [      Lists*ListContextBits-1:0] bound_context_i,
    input  logic [               Lists*R2Bits-1:0] bound_i,
    // leaves without candidates
    output logic                                   empty_valid_o,
    output logic [                ContextBits-1:0] empty_context_o,
    // beats of candidates, for each list
    output logic [                      Lists-1:0] out_valid_o,
    input  logic [                      Lists-1:0] out_ready_i,
    output logic [      Lists*ListContextBits-1:0] out_context_o,
    output logic [             Lists*BeatBits-1:0] out_beat_o,
    output logic [              Lists*RowBits-1:0] out_row_o,
    output logic [                      Lists-1:0] out_last_o,
    output logic [                Lists*Lanes-1:0] out_mask_o,
    output logic [         Lists*Lanes*R2Bits-1:0] out_d2_o,
    // directions of a beat, read when it is taken, and loads of a row: both in the next cycle
    input  logic [                      Lists-1:0] direction_read_i,
    output logic [2*Lists*Lanes*DirectionBits-1:0] directions_o,
    input  logic [              Lists*RowBits-1:0] load_row_i,
    output logic [       Lists*Lanes*LoadBits-1:0] loads_o,
    // a line, a tag of the cache was not right
    output logic                                   line_wrong_o,
    output logic [                ContextBits-1:0] line_wrong_context_o,
    output logic                                   tag_wrong_o,
    // counted events
    output logic                                   hit_o,
    output logic                                   miss_o
);
  localparam bit Compressed = photonloom_pkg::LinesCompressed != 0;
  localparam int unsigned RecordBits = photonloom_pkg::RecordBits;
  localparam int unsigned SlotHeaderBits = photonloom_pkg::SlotHeaderBits;
  localparam int unsigned HeaderBits = Compressed ? Bucket * SlotHeaderBits : 1;

  // Of several trees and lists, and of far gatherers of many contexts, whose clients lie all over the part.
  localparam bit CompareStage = Wide || (photonloom_pkg::FarGatherers != 0 && Contexts > 16);

  if (8 * photonloom_pkg::PhotonBytes < RecordBits + SlotHeaderBits) begin : gen_bad_photon
    photon_bytes_must_hold_all_fields_of_a_photon bad_photon ();
  end

  logic line_issue, line_valid;
  logic [Lists-1:0] queue_ready;
  logic [ContextBits-1:0] line_context, lane_context, lane_bound_context;
  logic [BeatBits-1:0] line_beat;
  logic [Lanes*PhotonBits-1:0] line_photons;
  logic [Lanes-1:0] line_used;
  logic [3*PositionBits-1:0] position;
  logic [ContextBits-1:0] position_context;
  logic [3*(PositionBits+1)-1:0] lane_query;
  logic read_valid;
  logic [ContextBits-1:0] read_context;
  logic [BeatBits-1:0] read_beat;
  logic [Lanes*RecordBits-1:0] read_records;
  logic [HeaderBits-1:0] read_header;
  logic [R2Bits-1:0] lane_bound;

  if (Sets != 0) begin : gen_cache
    cache #(
        .AddressBits(AddressBits + 1),
        .Clients(Contexts),
        .Items(Bucket),
        .ItemBytes(photonloom_pkg::PhotonBytes),
        .ItemBits(RecordBits),
        .HeaderBits(SlotHeaderBits),
        .Parts(Beats),
        .BeatBits(LineBeatBits),
        .Parity(Parity),
        .Sets(Sets),
        .Ways(CacheWays),
        .Misses(CacheMisses),
        .CompareStage(CompareStage)
    ) leaf_cache (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .invalidate_i(forget_i),
        .set_mask_i(set_mask_i),
        .bypass_i(bypass_i),
        .in_valid_i(leaf_valid_i || next_valid_i),
        .in_client_i(leaf_valid_i ? leaf_context_i : next_context_i),
        .in_address_i(leaf_valid_i ? leaf_address_i : next_address_i),
        .ready_i(queue_ready == '1),
        .issue_o(line_issue),
        .out_valid_o(read_valid),
        .out_client_o(read_context),
        .out_part_o(read_beat),
        .out_data_o(read_records),
        .out_header_o(read_header),
        .out_wrong_o(line_wrong_o),
        .line_req_valid_o(line_req_valid_o),
        .line_req_ready_i(line_req_ready_i),
        .line_req_addr_o(line_req_addr_o),
        .line_req_tag_o(line_req_tag_o),
        .line_rsp_valid_i(line_rsp_valid_i),
        .line_rsp_tag_i(line_rsp_tag_i),
        .line_rsp_data_i(line_rsp_data_i),
        .hit_o(hit_o),
        .miss_o(miss_o),
        .tag_wrong_o(tag_wrong_o)
    );
  end else begin : gen_uncached
    photon_gatherer_uncached #(
        .Contexts(Contexts),
        .AddressBits(AddressBits + 1),
        .Items(Bucket),
        .ItemBytes(photonloom_pkg::PhotonBytes),
        .ItemBits(RecordBits),
        .Parts(Beats),
        .BeatBits(LineBeatBits),
        .Parity(Parity)
    ) lines (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(leaf_valid_i),
        .in_context_i(leaf_context_i),
        .in_address_i(leaf_address_i),
        .ready_i(queue_ready == '1),
        .issue_o(line_issue),
        .out_valid_o(read_valid),
        .out_context_o(read_context),
        .out_part_o(read_beat),
        .out_data_o(read_records),
        .out_wrong_o(line_wrong_o),
        .line_req_valid_o(line_req_valid_o),
        .line_req_ready_i(line_req_ready_i),
        .line_req_addr_o(line_req_addr_o),
        .line_req_tag_o(line_req_tag_o),
        .line_rsp_valid_i(line_rsp_valid_i),
        .line_rsp_tag_i(line_rsp_tag_i),
        .line_rsp_data_i(line_rsp_data_i)
    );
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, forget_i, set_mask_i, bypass_i, next_valid_i, next_context_i, next_address_i};
    assign read_header = '0;
    assign miss_o = line_issue;
    assign {hit_o, tag_wrong_o} = '0;
    if (Compressed) begin : gen_bad_lines
      compressed_lines_need_a_leaf_cache bad_lines ();
    end
  end
  if (Parity != 0) begin : gen_parity
    always_ff @(posedge clk_i) line_wrong_context_o <= read_context;
  end else begin : gen_no_parity
    assign line_wrong_context_o = '0;
  end

  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) positions (
      .clk_i(clk_i),
      .write_i(start_i),
      .write_address_i(start_context_i),
      .write_data_i(start_position_i),
      .read_address_i(position_context),
      .read_data_o(position)
  );

  // ---- what the lanes measure: positions and the query's, or both less the line's corner ----
  assign next_ready_o = !leaf_valid_i;
  assign line_context_o = line_context;
  if (Compressed) begin : gen_decoder
    logic [3*PositionBits-1:0] corner;
    logic more;
    logic [3*(PositionBits+1)-1:0] query_q;

    photon_gatherer_decoder #(
        .Contexts(Contexts),
        .Lanes(Lanes)
    ) decoder (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .in_valid_i(read_valid),
        .in_context_i(read_context),
        .in_beat_i(read_beat),
        .in_records_i(read_records),
        .in_header_i(read_header),
        .out_valid_o(line_valid),
        .out_context_o(line_context),
        .out_beat_o(line_beat),
        .out_used_o(line_used),
        .out_photons_o(line_photons),
        .out_corner_o(corner),
        .out_last_o(line_last_o),
        .out_more_o(more),
        .out_next_o(line_next_o)
    );
    // Where a line is not right nobody knows which would be the next.
    assign line_more_o = more && !line_wrong_o;
    assign position_context = line_context;
    for (genvar c = 0; c < 3; c++) begin : gen_coordinate
      always_ff @(posedge clk_i)
        query_q[(PositionBits+1)*c+:PositionBits+1] <=
            {1'b0, position[PositionBits*c+:PositionBits]} - {1'b0, corner[PositionBits*c+:PositionBits]};
    end
    assign lane_query = query_q;
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = &{1'b0, lane_context};
  end else begin : gen_plain
    /* verilator lint_off UNUSEDSIGNAL */
    logic unused;
    /* verilator lint_on UNUSEDSIGNAL */
    assign unused = read_header[0];
    assign {line_valid, line_context, line_beat} = {read_valid, read_context, read_beat};
    assign line_photons = read_records;
    assign line_used = '0;
    assign {line_last_o, line_more_o, line_next_o} = '0;
    assign position_context = lane_context;
    for (genvar c = 0; c < 3; c++) begin : gen_coordinate
      assign lane_query[(PositionBits+1)*c+:PositionBits+1] = {1'b0, position[PositionBits*c+:PositionBits]};
    end
  end

  photon_gatherer_bounds #(
      .Contexts(Contexts),
      .Lists(Lists),
      .R2Bits(R2Bits)
  ) bounds (
      .clk_i(clk_i),
      .write_i(bound_write_i),
      .write_context_i(bound_context_i),
      .write_bound_i(bound_i),
      .read_context_i(lane_bound_context),
      .read_bound_o(lane_bound)
  );

  logic kept_valid, keep, kept_last;
  logic [ContextBits-1:0] kept_context;
  logic [BeatBits-1:0] kept_beat;
  logic [Lanes-1:0] kept_mask;
  logic [Lanes*R2Bits-1:0] kept_d2;
  logic [Lanes*LoadBits-1:0] kept_loads;

  photon_gatherer_lanes #(
      .PositionBits(PositionBits),
      .Contexts(Contexts),
      .Bucket(Bucket),
      .Lanes(Lanes),
      .LoadBits(LoadBits),
      .MantissasBits(MantissasBits),
      .ExponentBits(ExponentBits),
      .UsedGiven(Compressed),
      .FromRegister(Sets == 0 && photonloom_pkg::FarGatherers != 0 && photonloom_pkg::NodesPerCycle > 1)
  ) lanes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(line_valid),
      .in_context_i(line_context),
      .in_beat_i(line_beat),
      .in_photons_i(line_photons),
      .in_used_i(line_used),
      .query_context_o(lane_context),
      .query_i(lane_query),
      .bound_context_o(lane_bound_context),
      .bound_i(lane_bound),
      .empty_valid_o(empty_valid_o),
      .empty_context_o(empty_context_o),
      .out_valid_o(kept_valid),
      .out_keep_o(keep),
      .out_context_o(kept_context),
      .out_beat_o(kept_beat),
      .out_last_o(kept_last),
      .out_mask_o(kept_mask),
      .out_d2_o(kept_d2),
      .out_loads_o(kept_loads)
  );

  for (genvar l = 0; l < Lists; l++) begin : gen_queue
    photon_gatherer_beat_queue #(
        .R2Bits(R2Bits),
        .Contexts(ListContexts),
        .Bucket(Bucket),
        .Lanes(Lanes),
        .DirectionBits(DirectionBits),
        .LoadBits(LoadBits),
        .Behind(Behind),
        .Ahead(Lanes > 4 || (WriteAlways && 3 * Beats <= 16) ? 1 : 0),
        .DistanceRows(Wide)
    ) queue (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .ready_o(queue_ready[l]),
        .issue_i(line_issue),
        .in_valid_i(kept_valid),
        .in_keep_i(keep && (32'(kept_context) & (Lists - 1)) == l),
        .in_context_i(ListContextBits'(kept_context >> $clog2(Lists))),
        .in_beat_i(kept_beat),
        .in_last_i(kept_last),
        .in_mask_i(kept_mask),
        .in_d2_i(kept_d2),
        .in_loads_i(kept_loads),
        .out_valid_o(out_valid_o[l]),
        .out_ready_i(out_ready_i[l]),
        .out_context_o(out_context_o[ListContextBits*l+:ListContextBits]),
        .out_beat_o(out_beat_o[BeatBits*l+:BeatBits]),
        .out_row_o(out_row_o[RowBits*l+:RowBits]),
        .out_last_o(out_last_o[l]),
        .out_mask_o(out_mask_o[Lanes*l+:Lanes]),
        .out_d2_o(out_d2_o[Lanes*R2Bits*l+:Lanes*R2Bits]),
        .direction_read_i(direction_read_i[l]),
        .directions_o(directions_o[2*Lanes*DirectionBits*l+:2*Lanes*DirectionBits]),
        .load_row_i(load_row_i[RowBits*l+:RowBits]),
        .loads_o(loads_o[Lanes*LoadBits*l+:Lanes*LoadBits])
    );
  end
endmodule
