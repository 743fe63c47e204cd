#pragma once

#include <string>
#include <vector>

#include "bench/deformation/summary.h"
#include "console.h"

namespace fascia {

// The results in text for a person, and as JSON. Numbers that are not finite are null there.

void sayStageHeading(const StageResult& stage, const std::string& more, const Console& console);
void sayRow(const StageResult& stage, std::size_t number, std::size_t points,
            const Console& console);
Json toJson(const StageResult& stage, std::size_t points);

// A row per contender, missed goals with an exclamation mark.
struct SummaryRow {
  std::string method;
  bool isJudged = false;  // by the goals
  std::vector<SummaryMeasure> measures;
};
void saySummary(const std::vector<SummaryRow>& rows, const Console& console);
Json toJson(const SummaryRow& row);

}  // namespace fascia
