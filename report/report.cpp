// SPDX-License-Identifier: Apache-2.0
#include "report/report.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <stdexcept>

#include "report/bundle.hpp"
#include "report/folder.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

// A name of an extra image that no folder has would be left out in silence.
void check_images(const ReportRequest& request, const Json& data) {
  for (const ExtraImage& image : request.images) {
    bool used = false;
    for (const Json& run : data.at("runs")) used |= run.at("name") == image.scene;
    for (const Json& study : data.at("studies"))
      for (const Json& scene : study.at("scenes")) used |= scene.at("scene") == image.scene;
    if (!used)
      throw std::runtime_error(fmt::format("--image {}/{}={}: no run and no study has a scene '{}'",
                                           image.scene, image.label, image.file, image.scene));
  }
}

}  // namespace

std::string report_page(const ReportRequest& request) {
  Payloads payloads;
  Json data = {{"program", request.program}, {"runs", Json::array()}, {"studies", Json::array()}};
  {
    const ProgressPhase phase(request.progress, "read", request.folders.size(), "folders");
    for (const std::string& folder : request.folders) {
      if (!std::filesystem::is_directory(folder))
        throw std::runtime_error(
            fmt::format("{}: is no folder, expected what cosim or sweep wrote", folder));
      if (is_run(folder))
        data["runs"].push_back(run_json(folder, request.images, payloads));
      else if (is_study(folder))
        data["studies"].push_back(study_json(folder, request.images, payloads));
      else
        throw std::runtime_error(fmt::format(
            "{}: is neither a run (golden.exr, timeline.json, summary.json, plan.toml) nor a study "
            "(points.json, results.csv, summary.json)",
            folder));
      phase.advance(1);
    }
  }
  check_images(request, data);
  std::string title;
  for (const char* kind : {"runs", "studies"})
    for (const Json& one : data.at(kind))
      title += (title.empty() ? "" : ", ") +
               one.at(kind[0] == 'r' ? "name" : "study").get<std::string>();

  // The policy forbids every request, so that the page cannot depend on a network. Images stand
  // behind the script: it draws before they are read.
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>Photonloom report: {}</title>\n<style>{}</style>\n</head>\n<body>\n"
      "<main id=\"page\"></main>\n<noscript>This page draws itself with JavaScript.</noscript>\n",
      escaped(title), kPageStyle);
  page += "<script type=\"text/plain\" id=\"data\">" +
          packed_text(data.dump(-1, ' ', false, Json::error_handler_t::replace)) + "</script>\n";
  page += "<script>";
  page += kPageScript;
  page += "</script>\n";
  for (size_t i = 0; i < payloads.blocks().size(); ++i)
    page += fmt::format("<script type=\"text/plain\" id=\"p{}\">", i) + payloads.blocks()[i] +
            "</script>\n";
  return page + "</body>\n</html>\n";
}

}  // namespace photonloom
