// SPDX-License-Identifier: Apache-2.0
#include "host/journal.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"
#include "host/frame.hpp"

namespace photonloom {

namespace {

// A record: words of what follows (its CRC not counted), query, result, photons, CRC-32 of all
// before. Words of 32 bits, little endian.
constexpr size_t kMaxWords = size_t{1} << 16;

void append(Bytes& to, const PacketLayout& layout, const void* packet) {
  std::vector<uint32_t> words(layout.words());
  layout.pack(packet, words.data());
  for (const uint32_t word : words) put_u32(to, word);
}

void extract(const Bytes& from, size_t& word, const PacketLayout& layout, void* packet) {
  std::vector<uint32_t> words(layout.words());
  for (uint32_t& w : words) w = get_u32(from, 4 * word++);
  layout.unpack(words.data(), packet);
}

}  // namespace

Journal::Journal(const Plan& plan, const std::string& map, const std::string& folder, bool resume)
    : plan_(plan),
      query_(PacketLayout::of<GatherQuery>(plan)),
      result_(PacketLayout::of<GatherResult>(plan)),
      photon_(PacketLayout::of<GatherPhoton>(plan)),
      path_(fmt::format("{}/board-{}-{}.journal", folder, plan_hash_text(plan), map)) {
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  descriptor_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw std::runtime_error(fmt::format("{}: cannot be opened: {}", path_, strerror(errno)));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor_);
    throw std::runtime_error(
        fmt::format("{}: another run of the same plan and map is using it", path_));
  }
  if (resume) {
    Record record;
    while (read_record(record)) {
      end_ = record.end;
      records_.push_back(std::move(record));
      record = {};
    }
    kept_ = records_.size();
  }
  cut(end_);
}

Journal::~Journal() {
  try {
    flush();
  } catch (const std::exception&) {
    // What is not kept is asked again.
  }
  close(descriptor_);
}

bool Journal::read_record(Record& record) {
  const auto read_at = [this](uint64_t at, Bytes& to) {
    return pread(descriptor_, to.data(), to.size(), static_cast<off_t>(at)) ==
           static_cast<ssize_t>(to.size());
  };
  Bytes head(4);
  if (!read_at(end_, head)) return false;
  const size_t words = get_u32(head, 0), fixed = query_.words() + result_.words();
  if (words < fixed || words > kMaxWords || (words - fixed) % photon_.words() != 0) return false;
  Bytes all(4 * (words + 2));
  if (!read_at(end_, all)) return false;
  if (link_crc({all.data(), 4 * (words + 1)}) != get_u32(all, 4 * (words + 1))) return false;
  size_t word = 1;
  extract(all, word, query_, &record.query);
  extract(all, word, result_, &record.result);
  record.photons.resize((words - fixed) / photon_.words());
  for (GatherPhoton& p : record.photons) extract(all, word, photon_, &p);
  record.end = end_ + all.size();
  return true;
}

void Journal::cut(uint64_t end) {
  end_ = end;
  if (ftruncate(descriptor_, static_cast<off_t>(end)) != 0 ||
      lseek(descriptor_, static_cast<off_t>(end), SEEK_SET) < 0)
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path_, strerror(errno)));
}

bool Journal::take(const GatherQuery& query, GatherResult& result,
                   std::vector<GatherPhoton>& photons) {
  if (taken_ == records_.size()) return false;
  const Record& record = records_[taken_];
  if (record.query != query) {
    cut(taken_ ? records_[taken_ - 1].end : 0);
    records_.resize(taken_);
    return false;
  }
  ++taken_;
  result = record.result;
  photons.insert(photons.end(), record.photons.begin(), record.photons.end());
  return true;
}

void Journal::add(const GatherQuery& query, const GatherResult& result,
                  std::span<const GatherPhoton> photons) {
  Bytes bytes;
  put_u32(bytes, static_cast<uint32_t>(query_.words() + result_.words() +
                                       photons.size() * photon_.words()));
  append(bytes, query_, &query);
  append(bytes, result_, &result);
  for (const GatherPhoton& p : photons) append(bytes, photon_, &p);
  put_u32(bytes, link_crc(bytes));
  ++added_;
  buffer_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

void Journal::flush() {
  for (size_t at = 0; at < buffer_.size();) {
    const ssize_t n = write(descriptor_, buffer_.data() + at, buffer_.size() - at);
    if (n < 0 && errno != EINTR) {
      const std::string reason = strerror(errno);
      buffer_.clear();
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path_, reason));
    }
    if (n > 0) at += static_cast<size_t>(n);
  }
  buffer_.clear();
}

void Journal::remove() {
  buffer_.clear();
  unlink(path_.c_str());
}

}  // namespace photonloom
