#include "bench/deformation/table.h"

#include <cmath>

#include <fmt/core.h>

namespace fascia {
namespace {

constexpr const char* kHeadings =
    "                    new             lumpiness    edge stretch     slide (mm)";
constexpr const char* kTableHead =
    "              crossings turned    RMS    99 %    99 % largest    RMS largest";

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

// Width 7 with its mark.
std::string cell(const SummaryMeasure& measure, bool isJudged) {
  const char* mark = isJudged && !measure.isMet() ? "!" : " ";
  if (!measure.isKnown()) return "      – ";
  if (measure.value != 0 && std::abs(measure.value) < 1e-3)
    return fmt::format("{:7.0e}{}", measure.value, mark);
  const bool isCount = measure.value == std::floor(measure.value) && measure.value < 1e6;
  return isCount ? fmt::format("{:7.0f}{}", measure.value, mark)
                 : fmt::format("{:7.2f}{}", measure.value, mark);
}

std::string goalCell(double goal) {
  if (!(goal == goal)) return "      – ";
  return goal < 1e-3 && goal > 0 ? fmt::format("{:>7} ", fmt::format("≤{:.0e}", goal))
                                 : fmt::format("{:>7} ", fmt::format("≤{:g}", goal));
}

}  // namespace

void sayStageHeading(const StageResult& stage, const std::string& more, const Console& console) {
  console.say("");
  console.say(stage.name + more);
  console.say(fmt::format("{}   {}", kHeadings,
                          stage.isPose ? "volume lost (%)" : "jitter   time per frame"));
  console.say(fmt::format("{}   {}", kTableHead,
                          stage.isPose ? "  total at rest" : "  (µm)     ms µs/point"));
}

void sayRow(const StageResult& stage, std::size_t number, std::size_t points,
            const Console& console) {
  const Score& s = stage.scores[number];
  const double frame_s = stage.frame_s[number];
  const std::string common = fmt::format(
      "{:16} {:6} {:6} {:7.4f} {:7.3f} {:6.2f} {:7.2f} {:6.1f} {:7.1f}", stage.methods[number],
      s.crossings, s.turned, s.lumpiness.rms, s.lumpiness.percentile99, s.stretch.percentile99,
      s.stretch.largest, 1e3 * s.slide.rms_m, 1e3 * s.slide.largest_m);
  if (stage.isPose)
    console.say(
        fmt::format("{}   {:7.1f} {:7.1f}", common, 100 * s.volume_loss, 100 * s.loss_at_rest));
  else
    console.say(fmt::format("{}   {:6.0f} {:6.2f} {:8.3f}", common, 1e6 * s.jitter_m, 1e3 * frame_s,
                            1e6 * frame_s / static_cast<double>(points)));
}

Json toJson(const StageResult& stage, std::size_t points) {
  Json::List rows;
  for (std::size_t i = 0; i < stage.scores.size(); ++i) {
    const Score& s = stage.scores[i];
    Json row = Json::Object{{"method", stage.methods[i]},
                            {"new_crossings", static_cast<int>(s.crossings)},
                            {"new_crossings_in_piece", static_cast<int>(s.crossings_in_piece)},
                            {"turned_triangles", static_cast<int>(s.turned)},
                            {"lumpiness_rms", number(s.lumpiness.rms)},
                            {"lumpiness_percentile99", number(s.lumpiness.percentile99)},
                            {"stretch_percentile99", number(s.stretch.percentile99)},
                            {"stretch_largest", number(s.stretch.largest)},
                            {"slide_rms_m", number(s.slide.rms_m)},
                            {"slide_largest_m", number(s.slide.largest_m)}};
    if (stage.isPose) {
      row.set("volume_loss", number(s.volume_loss));
      row.set("volume_loss_at_rest", number(s.loss_at_rest));
      row.set("rest_error_m", number(s.rest_error_m));
    } else {
      row.set("jitter_m", number(s.jitter_m));
    }
    row.set("frame_s", stage.frame_s[i]);
    row.set("point_frame_us", 1e6 * stage.frame_s[i] / static_cast<double>(points));
    rows.push_back(std::move(row));
  }
  return rows;
}

void saySummary(const std::vector<SummaryRow>& rows, const Console& console) {
  // A cell is 8 wide, the last for its mark.
  console.say("");
  console.say(fmt::format("{:17}{:^16}{:^16}{:^16}{:^16}{:^16}{:>7} {:>7} {:>7}", "against",
                          "crossings", "turned", "lumpiness", "volume", "99 % stretch", "jitter",
                          "error", "µs per"));
  std::string columns = fmt::format("{:17}", "linear blend");
  for (const char* column : {"poses", "clips", "poses", "clips", "median", "worst", "lost", "gain",
                             "median", "worst", "worst", "at rest", "point"})
    columns += fmt::format("{:>7} ", column);
  console.say(columns);
  for (const SummaryRow& row : rows) {
    std::string line = fmt::format("{:17}", row.method);
    for (const SummaryMeasure& measure : row.measures) line += cell(measure, row.isJudged);
    console.say(line);
  }
  for (const SummaryRow& row : rows) {
    if (!row.isJudged) continue;
    std::string line = fmt::format("{:17}", "goal");
    std::string missed;
    for (const SummaryMeasure& measure : row.measures) {
      line += goalCell(measure.goal);
      if (!measure.isMet()) missed += (missed.empty() ? "" : "; ") + measure.meaning;
    }
    console.say(line);
    console.say(fmt::format("{}: {}", row.method,
                            missed.empty() ? "every goal met" : "goals missed: " + missed));
  }
}

Json toJson(const SummaryRow& row) {
  Json measures = Json::Object{};
  for (const SummaryMeasure& measure : row.measures) {
    Json entry = Json::Object{{"value", number(measure.value)}};
    if (row.isJudged && measure.goal == measure.goal) {
      entry.set("goal", measure.goal);
      entry.set("met", measure.isMet());
    }
    measures.set(measure.key, std::move(entry));
  }
  return Json::Object{{"method", row.method}, {"measures", std::move(measures)}};
}

}  // namespace fascia
