#include <fascia/base/tunable.h>

#include <charconv>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/base/suggest.h>

namespace fascia {
namespace {

constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;
// Degrees are rounded when they become radians: an end that a person wrote must stay inside.
constexpr double kAngleSlack_deg = 1e-9;

template <class T>
std::string shortest(T value) {
  if (value == 0 && std::signbit(value)) return "-0.0";  // "-0" would be read as an integer
  char buffer[48];
  std::string digits(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  const std::size_t exponent = digits.find('e');  // "1e+06": people write 1e6
  if (exponent == std::string::npos) return digits;
  if (digits[exponent + 1] == '+') digits.erase(exponent + 1, 1);
  const std::size_t sign = digits[exponent + 1] == '-' ? 1 : 0;
  const std::size_t first = digits.find_first_of("123456789", exponent + 1);
  if (first != std::string::npos) digits.erase(exponent + 1 + sign, first - exponent - 1 - sign);
  return digits;
}

std::string digits(double value, int precision) {
  char buffer[32];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, precision)
          .ptr;
  return {buffer, end};
}

std::string bracketed(const NumberRange& range) {
  std::string out(1, range.aboveMin ? '(' : '[');
  out += shortestText(range.min) + ", " + shortestText(range.max);
  return out + ']';
}

}  // namespace

std::string shortestText(double value) {
  return shortest(value);
}
std::string shortestText(float value) {
  return shortest(value);
}

std::string NumberRange::text() const {
  return "a number in " + bracketed(*this);
}

std::string NumberRange::wholeText() const {
  return "a whole number in " + bracketed(*this);
}

std::string wordFault(std::string_view found, const std::vector<std::string_view>& words,
                      std::string& hint) {
  NearestName nearest(found);
  std::string all;
  for (const std::string_view word : words) {
    if (word == found) return {};
    nearest.offer(word);
    all += (all.empty() ? "" : ", ") + std::string(word);
  }
  hint = nearest.hint();
  return "found " + quotedName(found) + ", expected one of " + all;
}

void checkNumber(const TunableInfo& row, double value, const std::string& pointer,
                 Diagnostics& diagnostics) {
  FASCIA_ASSERT(row.range.min < row.range.max, "a tunable has room");
  NumberRange range = row.range;
  if (row.isAngle())
    value *= kDegreesPerRadian, range.min -= kAngleSlack_deg, range.max += kAngleSlack_deg;
  if (range.contains(value)) return;  // false for NaN
  // A person's degrees have been radians in between: their last digits are not the person's.
  const std::string found = row.isAngle() ? digits(value, 12) : shortestText(value);
  diagnostics.error(pointer, "found " + found + ", expected " + row.range.text());
}

void checkWhole(const TunableInfo& row, int value, const std::string& pointer,
                Diagnostics& diagnostics) {
  if (row.range.contains(static_cast<double>(value))) return;
  diagnostics.error(pointer,
                    "found " + std::to_string(value) + ", expected " + row.range.wholeText());
}

}  // namespace fascia
