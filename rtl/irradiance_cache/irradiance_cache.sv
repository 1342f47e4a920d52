// SPDX-License-Identifier: Apache-2.0
// Points in, for each the heaviest records of its tile that cover it; one that none covers becomes a record where it
// asks for that and there is room. Golden: golden/unit/irradiance_cache.cpp; definition: docs/irradiance_cache.md.
//
// A lookup goes through the tile's records, one a cycle, then takes one cycle more: n + 1 cycles with n records, and no
// fewer than 15, or 16 behind one that made a record, since a lookup ends only when the one before has been decided. Latency 15 cycles from its last record.
module irradiance_cache #(
    parameter int unsigned Records = photonloom_pkg::CacheRecords,
    parameter int unsigned Hits = photonloom_pkg::CacheHits,
    parameter int unsigned RecordBits = photonloom_pkg::CacheRecordBits,
    parameter int unsigned WeightBits = photonloom_pkg::CacheWeightBits
) (
    input  logic clk_i,  // clock
    input  logic rst_i,  // reset, synchronous
    input  logic in_valid_i,  // offered
    output logic in_ready_o,  // taken when offered
    input  photonloom_pkg::cache_lookup_t in_i,  // the packet
    output logic out_valid_o,  // offered
    input  logic out_ready_i,  // taken when offered
    output photonloom_pkg::cache_result_t out_o,  // the packet
    output logic [31:0] count_lookups_o,  // packets taken in
    output logic [31:0] count_hits_o,  // points that some record covers
    output logic [31:0] count_records_made_o,  // points that became records
    output logic [31:0] count_full_o,  // points that would have, in a full tile
    output logic [31:0] count_records_read_o,  // records compared with a point
    output logic [31:0] count_cycles_busy_o,  // cycles with a lookup under way
    output logic [31:0] count_cycles_waiting_o  // of them those that waited for the lookup before to be decided
);
  localparam int unsigned PositionBits = photonloom_pkg::PositionBits;
  localparam int unsigned NormalBits = photonloom_pkg::NormalBits;
  localparam int unsigned FalloffBits = photonloom_pkg::CacheFalloffBits;
  localparam int unsigned ExponentBits = photonloom_pkg::CacheFalloffExponentBits;
  localparam int unsigned HitBits = photonloom_pkg::CacheHitBits;
  localparam int unsigned CountBits = $clog2(Records + 1);
  localparam int unsigned PlaceBits = 3 * PositionBits + 3 * NormalBits;
  localparam int unsigned RecordWidth = PlaceBits + FalloffBits + 1 + ExponentBits;
  localparam int unsigned WeightLatency = 13;  // 2 of the memory and 11 of the arithmetic

  photonloom_pkg::cache_lookup_t packet, scan_q;
  /* verilator lint_off UNUSEDSIGNAL */  // whether it cleared the records does not matter any more
  photonloom_pkg::cache_lookup_t drain_q;
  /* verilator lint_on UNUSEDSIGNAL */
  logic valid, ready;
  skid_buffer #(
      .Width(photonloom_pkg::CacheLookupPacketBits)
  ) incoming (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .out_valid_o(valid),
      .out_ready_i(ready),
      .out_o(packet)
  );

  // scan_q goes through the records; drain_q has gone through all of them and waits for its answer. Records come in only
  // when drain_q is answered, so the lookup behind it ends after that and has seen every record before its own.
  logic scan_valid_q, drain_valid_q;
  logic [CountBits-1:0] records_q, next_q;
  logic read, at_end, end_scan, decide_q, room, out_ready;
  assign at_end = next_q == records_q;
  assign read = scan_valid_q && !at_end;
  assign end_scan = scan_valid_q && at_end && !drain_valid_q && out_ready;
  assign ready = packet.clear ? !scan_valid_q && !drain_valid_q : !scan_valid_q || end_scan;

  // The tile's records.
  logic insert;
  logic [RecordWidth-1:0] record, record_q;
  localparam int unsigned AddressBits = Records > 1 ? $clog2(Records) : 1;
  block_ram #(
      .Width(RecordWidth),
      .Depth(Records)
  ) store (
      .clk_i(clk_i),
      .write_i(insert),
      .write_address_i(AddressBits'(records_q)),
      .write_data_i({drain_q.position, drain_q.normal, drain_q.falloff, drain_q.falloff_exponent}),
      .read_i(1'b1),
      .read_address_i(AddressBits'(next_q)),
      .read_data_o(record)
  );

  logic [PlaceBits-1:0] place_q, point_q;
  logic [WeightBits:0] weight, weight_if_read;
  always_ff @(posedge clk_i) begin
    place_q  <= {scan_q.position, scan_q.normal};
    point_q  <= place_q;
    record_q <= record;
  end
  irradiance_weight weigh (
      .clk_i(clk_i),
      .point_i(point_q[3*NormalBits+:3*PositionBits]),
      .point_normal_i(point_q[0+:3*NormalBits]),
      .record_i(record_q[RecordWidth-1-:3*PositionBits]),
      .record_normal_i(record_q[FalloffBits+1+ExponentBits+:3*NormalBits]),
      .falloff_i(record_q[ExponentBits+:FalloffBits+1]),
      .exponent_i(record_q[0+:ExponentBits]),
      .weight_o(weight)
  );

  // Beside the arithmetic: whether a record was read, which, and whether the lookup ends.
  logic [WeightLatency-1:0] read_q, end_q;
  logic [WeightLatency*RecordBits-1:0] number_q;
  logic [HitBits-1:0] count;
  logic [Hits*(WeightBits+1)-1:0] weights;
  logic [Hits*RecordBits-1:0] numbers;
  logic clear_list_q;  // after reset too
  assign weight_if_read = read_q[WeightLatency-1] ? weight : '0;
  irradiance_list heaviest (
      .clk_i(clk_i),
      .clear_i(clear_list_q),
      .weight_i(weight_if_read),
      .record_i(number_q[(WeightLatency-1)*RecordBits+:RecordBits]),
      .count_o(count),
      .weights_o(weights),
      .records_o(numbers)
  );

  // The answer.
  photonloom_pkg::cache_result_t result;
  logic wanted;
  assign room   = records_q != CountBits'(Records);
  assign wanted = decide_q && count == '0 && drain_q.insert;
  assign insert = wanted && room;
  always_comb begin
    result.pixel = drain_q.pixel;
    result.sample = drain_q.sample;
    result.count = count;
    result.record = numbers;
    result.weight = weights;
    result.inserted = insert;
    result.full = wanted && !room;
    result.number = insert ? RecordBits'(records_q) : '0;
  end
  fifo #(
      .Width(photonloom_pkg::CacheResultPacketBits),
      .Depth(2)
  ) outgoing (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(decide_q),
      .in_ready_o(out_ready),
      .in_i(result),
      .out_valid_o(out_valid_o),
      .out_ready_i(out_ready_i),
      .out_o(out_o)
  );

  always_ff @(posedge clk_i) begin
    if (read) next_q <= next_q + 1'b1;
    if (end_scan) begin
      scan_valid_q <= 1'b0;
      drain_valid_q <= 1'b1;
      drain_q <= scan_q;
    end
    if (valid && ready) begin
      scan_valid_q <= 1'b1;
      scan_q <= packet;
      next_q <= '0;
      if (packet.clear) records_q <= '0;
    end
    read_q <= {read_q[WeightLatency-2:0], read};
    end_q <= {end_q[WeightLatency-2:0], end_scan};
    number_q <= {number_q[0+:(WeightLatency-1)*RecordBits], RecordBits'(next_q)};
    decide_q <= end_q[WeightLatency-1];
    clear_list_q <= end_q[WeightLatency-1] || rst_i;
    if (decide_q) drain_valid_q <= 1'b0;
    if (insert) records_q <= records_q + 1'b1;
    if (rst_i) begin
      scan_valid_q <= 1'b0;
      drain_valid_q <= 1'b0;
      records_q <= '0;
      read_q <= '0;
      end_q <= '0;
      decide_q <= 1'b0;
    end
  end

  counter lookups (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(valid && ready),
      .count_o(count_lookups_o)
  );
  counter hits (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(decide_q && count != '0),
      .count_o(count_hits_o)
  );
  counter records_made (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(insert),
      .count_o(count_records_made_o)
  );
  counter full (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(wanted && !room),
      .count_o(count_full_o)
  );
  counter records_read (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(read),
      .count_o(count_records_read_o)
  );
  counter cycles_busy (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(scan_valid_q || drain_valid_q),
      .count_o(count_cycles_busy_o)
  );
  counter cycles_waiting (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .event_i(scan_valid_q && at_end && !end_scan),
      .count_o(count_cycles_waiting_o)
  );
endmodule
