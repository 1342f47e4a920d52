// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>

#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"
#include "tests/catch.hpp"

using namespace photonloom;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / ("photonloom-test-" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(path), {}));
  }
};

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

Image sample_image() {
  Image image;
  image.width = 5;
  image.height = 3;
  for (const char* name : {"R", "G", "B", "direct.R", "N.X", "photonDensity.Y"}) image.add(name);
  for (size_t c = 0; c < image.channels.size(); ++c)
    for (size_t i = 0; i < 15; ++i)
      image.channels[c].pixels[i] =
          std::ldexp(static_cast<float>(i * 7 + c + 1), 20 * static_cast<int>(c) - 60);
  image.channels[0].pixels[0] = std::numeric_limits<float>::max();
  image.channels[0].pixels[1] = std::numeric_limits<float>::denorm_min();
  image.metadata["scene"] = "cornell";
  image.metadata["seed"] = "1";
  return image;
}

}  // namespace

TEST_CASE("an EXR comes back bit for bit, with its metadata") {
  const Folder folder;
  const Image image = sample_image();
  write_exr(image, folder / "a.exr");
  const Image back = read_exr(folder / "a.exr");
  REQUIRE(back.width == 5);
  REQUIRE(back.height == 3);
  REQUIRE(back.channels.size() == image.channels.size());
  for (const Channel& c : image.channels) {
    REQUIRE(back.find(c.name));
    REQUIRE(back.find(c.name)->pixels == c.pixels);
  }
  REQUIRE(back.metadata == image.metadata);
  write_exr(image, folder / "b.exr");
  REQUIRE(read_file(folder / "a.exr") == read_file(folder / "b.exr"));
  REQUIRE(folder.files() == 2);
}

TEST_CASE("what is no EXR is refused by name and kind") {
  const Folder folder;
  Image image = sample_image();
  write_png(image, folder / "a.png");
  fs::rename(folder / "a.png", folder / "a.exr");
  REQUIRE(contains(message([&] { read_exr(folder / "a.exr"); }),
                   "a.exr: is not an OpenEXR file: it is a PNG"));
  REQUIRE(contains(message([&] { read_exr(folder / "none.exr"); }), "none.exr: cannot be read"));
  REQUIRE(contains(message([&] { read_exr(folder.path.string()); }), "cannot be read"));
  write_file(folder / "e.exr", "");
  REQUIRE(contains(message([&] { read_exr(folder / "e.exr"); }), "it is empty"));
}

TEST_CASE("a truncated or damaged EXR is an error at every length") {
  const Folder folder;
  write_exr(sample_image(), folder / "a.exr");
  const std::string whole = read_file(folder / "a.exr");
  for (size_t n = 4; n < whole.size(); ++n) {
    write_file(folder / "b.exr", whole.substr(0, n));
    INFO("first " << n << " of " << whole.size() << " bytes");
    REQUIRE(contains(message([&] { read_exr(folder / "b.exr"); }), "b.exr: "));
  }
}

TEST_CASE("an EXR that claims more than it holds is refused before room is made for it") {
  const Folder folder;
  write_exr(sample_image(), folder / "a.exr");
  const std::string whole = read_file(folder / "a.exr");
  const size_t compression =
      whole.find("compression") + sizeof "compression" + sizeof "compression";
  std::string claims = whole;
  claims.replace(compression, 4, "\xff\xff\xff\x7f", 4);
  write_file(folder / "b.exr", claims);
  REQUIRE(contains(message([&] { read_exr(folder / "b.exr"); }),
                   "b.exr: attribute compression of a header claims 2147483647 bytes"));
  claims.replace(whole.find("compression"), 2, "\x1b\n");  // which a terminal would obey
  write_file(folder / "b.exr", claims);
  REQUIRE(contains(message([&] { read_exr(folder / "b.exr"); }),
                   "b.exr: attribute \\x1b\\x0ampression of a header claims"));
  claims = whole;
  const size_t window = whole.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 4;
  claims.replace(window + 8, 4, "\xff\xff\xff\x03", 4);  // wide and low
  write_file(folder / "b.exr", claims);
  REQUIRE(
      contains(message([&] { read_exr(folder / "b.exr"); }), "b.exr: has 67108864 x 3 pixels in"));
}

TEST_CASE("a folder that has come to hold a user's file is not replaced, and nothing is lost") {
  const Folder folder;
  const OutputFolderKind kind{"mark", "made", {}};
  fs::create_directory(folder / "a");
  OutputFolder out(folder / "a", kind);
  write_file(out.temporary() + "/mark", "made");
  write_file(folder / "a/notes", "mine");
  const std::string made = out.temporary(), why = message([&] { out.commit(); });
  REQUIRE(contains(why, "a: is not replaced: "));
  REQUIRE(contains(why, "is in " + made));
  REQUIRE(read_file(folder / "a/notes") == "mine");
  REQUIRE(read_file(made + "/mark") == "made");
}

TEST_CASE("outputs appear whole or not at all") {
  const Folder folder;
  {
    OutputFile file(folder / "a");
    file.write("half");
    REQUIRE_FALSE(fs::exists(folder / "a"));
  }
  REQUIRE(folder.files() == 0);
  write_file(folder / "a", "one");
  {
    OutputFile file(folder / "a");
    file.write("other");
  }
  REQUIRE(read_file(folder / "a") == "one");
  {
    OutputFolder out(folder / "dir");
    write_file(out.temporary() + "/x", "1");
  }
  REQUIRE_FALSE(fs::exists(folder / "dir"));
  {
    OutputFolder out(folder / "dir");
    fs::remove(out.temporary());
    REQUIRE(message([&] { OutputFile file(out.temporary() + "/x"); }) ==
            folder / "dir/x" + ": cannot be created: No such file or directory");
  }
  for (const char* text : {"1", "2"}) {
    OutputFolder out(folder / "dir/");
    write_file(out.temporary() + "/x", text);
    out.commit();
    REQUIRE(read_file(folder / "dir/x") == text);
  }
  REQUIRE(folder.files() == 2);
}

TEST_CASE("a folder that somebody else filled is not replaced") {
  const Folder folder;
  const std::string dir = folder / "dir";
  const auto make = [&] {
    OutputFolder out(dir, {"mark", "written by", {"rtl", "*.exr"}});
    write_file(out.temporary() + "/mark", "written by a test");
    out.commit();
  };
  const auto refused = [&](const std::string& why) {
    return dir + ": is not replaced: " + why +
           ", expected a new folder, an empty one, or one that was written by the same command";
  };
  fs::create_directory(dir);
  make();  // empty
  fs::create_directory(dir + "/rtl");
  write_file(dir + "/image.exr", "");
  make();  // its own
  REQUIRE(folder.files() == 1);
  write_file(dir + "/precious", "kept");
  REQUIRE(message(make) == refused("it also holds precious"));
  fs::remove(dir + "/mark");
  REQUIRE(message(make) == refused("it holds files but no mark"));
  fs::remove(dir + "/precious");
  write_file(dir + "/mark", "of another program");
  REQUIRE(message(make) == refused("its mark is another one"));
  REQUIRE(read_file(dir + "/mark") == "of another program");
  REQUIRE(folder.files() == 1);
}

TEST_CASE("an input is not replaced by what is made of it") {
  const Folder folder;
  const std::string input = folder / "in.xml";
  write_file(input, "a scene");
  fs::create_symlink(input, folder / "link.xml");
  refuse_to_replace_input(folder / "out.ply", input);
  for (const std::string& output : {input, folder / "link.xml", folder / "./in.xml"})
    CHECK(message([&] { refuse_to_replace_input(output, input); }) ==
          output + ": is the input, which would be lost; expected another file to write");
}

TEST_CASE("the folder in which the program runs is not replaced") {
  const Folder folder;
  const fs::path before = fs::current_path();
  fs::create_directory(folder / "below");
  fs::current_path(folder / "below");
  std::vector<std::string> messages;
  for (const char* name : {".", "..", "../below", "/"})
    messages.push_back(message([&] { OutputFolder out(name); }));
  fs::current_path(before);
  for (const std::string& text : messages)
    CHECK(contains(text, "cannot be replaced: the program runs in it"));
  REQUIRE(folder.files() == 1);
}

TEST_CASE("a full disk, a missing folder and a folder as target are one clear error each") {
  const Folder folder;
  const Image image = sample_image();
  REQUIRE(contains(message([&] { write_exr(image, "/dev/full"); }),
                   "/dev/full: cannot be written: No space left"));
  REQUIRE(fs::is_character_file("/dev/full"));
  REQUIRE(contains(message([&] { write_exr(image, folder / "no/a.exr"); }),
                   "no/a.exr: cannot be created"));
  REQUIRE(contains(message([&] { write_png(image, folder.path.string()); }), "it is a folder"));
  REQUIRE(folder.files() == 0);
}

TEST_CASE("the sRGB curve at its published points") {
  // IEC 61966-2-1: linear below 0.0031308; 1/2 codes to 1.055 * 2^(-1/2.4) - 0.055 = 0.73536.
  REQUIRE(srgb_byte(0) == 0);
  REQUIRE(srgb_byte(-1) == 0);
  REQUIRE(srgb_byte(std::nan("")) == 0);
  REQUIRE(srgb_byte(1) == 255);
  REQUIRE(srgb_byte(1e9) == 255);
  REQUIRE(srgb_byte(0.002) == std::lround(12.92 * 0.002 * 255));
  REQUIRE(srgb_byte(0.5) == 188);
}
