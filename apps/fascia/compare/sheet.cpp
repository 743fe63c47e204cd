#include "compare/sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include <fascia/render/overlay.h>

namespace fascia {
namespace {

const Ink kPaper{{0.115f, 0.125f, 0.14f}, 1};     // between pictures and below them
const Ink kVeil{{0.115f, 0.125f, 0.14f}, 0.78f};  // behind letters on pictures
const Ink kBright{{1, 1, 1}, 1};
const Ink kDim{{0.66f, 0.69f, 0.73f}, 1};
const Ink kAccent{{1.f, 0.62f, 0.18f}, 0.95f};
constexpr double kBold = 0.125;

// A number and what it counts, for both sides.
struct Column {
  Both<std::string> numbers;
  std::string unit;
  Both<bool> better;
};

template <class T>
Column column(const Both<T>& values, const char* format, const char* unit) {
  Column out;
  for (const Side side : kSides)
    out.numbers[side] = fmt::format(fmt::runtime(format), values[side]);
  out.unit = unit;
  out.better.plain = values.plain <= values.ours;
  out.better.ours = values.ours <= values.plain;
  return out;
}

std::string inMillimetres(double length_m) {
  const double mm = 1e3 * length_m;
  return mm < 10 ? fmt::format("{:.1f} mm", mm) : fmt::format("{:.0f} mm", mm);
}

// The measures as a table of a row per side; measured before it is drawn.
class FigureTable {
 public:
  FigureTable(const SheetText& text, const Moment& moment) : text_(text) {
    const auto& [plain, ours] = moment.faults;
    columns_.push_back(
        column<std::size_t>({plain.crossings, ours.crossings}, "{}", "new crossings"));
    columns_.push_back(column<std::size_t>({plain.turned, ours.turned}, "{}", "turned triangles"));
    columns_.push_back(column<double>({plain.stretch, ours.stretch}, "{:.2f}", "stretch (99 %)"));
    apart_ = "up to " + inMillimetres(moment.apart_m) + " apart";
  }

  void draw(const Cell& cell, double size, Pixels& picture) const {
    const double margin = size, room = cell.width - 2 * margin;
    size *= std::min(1.0, room / std::max(1.0, width(size)));
    const double x = cell.x + margin, right = cell.x + cell.width - margin;
    double baseline = cell.y + 0.5 * cell.height - 0.42 * size;
    for (const Side side : kSides) {
      row(side, x, baseline, size, picture);
      const std::string& at = side == Side::plain ? text_.title : apart_;
      const TextStyle style = plain(size, kDim);
      drawText(picture, right - textWidth(at, style), baseline, at, style);
      baseline += 1.55 * size;
    }
  }

 private:
  static TextStyle plain(double size, const Ink& ink) { return {.size = size, .ink = ink}; }
  static TextStyle bold(double size, const Ink& ink) {
    return {.size = size, .weight = kBold, .ink = ink};
  }
  double namesWidth(double size) const {
    double most = 0;
    for (const Side side : kSides)
      most = std::max(most, textWidth(text_.names[side], bold(size, kBright)));
    return most;
  }
  static double numbersWidth(const Column& column, double size) {
    double most = 0;
    for (const Side side : kSides)
      most = std::max(most, textWidth(column.numbers[side], bold(size, kBright)));
    return most;
  }
  double width(double size) const {
    double sum = namesWidth(size);
    for (const Column& column : columns_)
      sum += 2.4 * size + numbersWidth(column, size) + textWidth(column.unit, plain(size, kDim));
    return sum + 2 * size +
           std::max(textWidth(text_.title, plain(size, kDim)),
                    textWidth(apart_, plain(size, kDim)));
  }
  void row(Side side, double x, double baseline, double size, Pixels& picture) const {
    drawText(picture, x, baseline, text_.names[side], bold(size, kBright));
    x += namesWidth(size);
    for (const Column& column : columns_) {
      x += 2 * size;
      const std::string& number = column.numbers[side];
      const TextStyle style = column.better[side] ? bold(size, kBright) : plain(size, kDim);
      const double width = numbersWidth(column, size);
      drawText(picture, x + width - textWidth(number, style), baseline, number, style);
      x += width + 0.4 * size;
      x = drawText(picture, x, baseline, column.unit, plain(size, kDim));
    }
  }

  const SheetText& text_;
  std::vector<Column> columns_;
  std::string apart_;
};

void chip(double x, double y, const std::string& text, const TextStyle& style, Pixels& picture) {
  const double pad = 0.55 * style.size;
  fillBox(picture, {x, y, textWidth(text, style) + 2 * pad, 1.6 * style.size}, kVeil,
          0.4 * style.size);
  drawText(picture, x + pad, y + 1.15 * style.size, text, style);
}

double chipWidth(const std::string& text, const TextStyle& style) {
  return textWidth(text, style) + 1.1 * style.size;
}

}  // namespace

Sheet::Sheet(Layout layout, SheetText text) : layout_(std::move(layout)), text_(std::move(text)) {}

void Sheet::begin(Pixels& picture) const {
  picture.width = layout_.width;
  picture.height = layout_.height;
  picture.rgba.assign(
      4 * static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height), 255);
  fillBox(picture, {0, 0, static_cast<double>(layout_.width), static_cast<double>(layout_.height)},
          kPaper);
}

void Sheet::addMain(Both<Pixels>& pictures, const Both<std::vector<Mark>>& marks, double wipe,
                    Pixels& picture) const {
  const Cell& first = layout_.mains.front();
  for (const Side side : kSides) addMarks(marks[side], pictures[side]);
  if (layout_.mains.size() == 2) {
    for (const Side side : kSides) {
      const Cell& cell = layout_.mains[side == Side::plain ? 0 : 1];
      place(pictures[side], cell.x, cell.y, picture);
      addName(cell, side, false, picture);
    }
    return;
  }
  const int column = static_cast<int>(std::lround(std::clamp(wipe, 0.0, 1.0) * first.width));
  place(pictures.ours, first.x, first.y, picture);
  placeColumns(pictures.plain, column, first.x, first.y, picture);
  const double thickness = std::max(2.0, 0.14 * layout_.text);
  fillBox(picture,
          {first.x + column - 0.5 * thickness, static_cast<double>(first.y), thickness,
           static_cast<double>(first.height)},
          {{1, 1, 1}, 0.9f});
  addName(first, Side::plain, false, picture);
  addName(first, Side::ours, true, picture);
}

// A white ring with a dark edge reads on every fur; its number sits on it.
void Sheet::addMarks(std::span<const Mark> marks, Pixels& picture) const {
  const double thickness = std::max(1.3, 0.1 * layout_.text);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const double x = marks[i].x * picture.width, y = marks[i].y * picture.height;
    const double radius = marks[i].radius * picture.height;
    drawRing(picture, x, y, radius, 2.6 * thickness, {kPaper.color, 0.35f});
    drawRing(picture, x, y, radius, thickness, kBright);
    if (marks.size() < 2) continue;
    const std::string number = fmt::format("{}", i + 1);
    const TextStyle style{.size = 0.85 * layout_.text, .weight = kBold, .ink = kAccent};
    const double disc = 0.8 * style.size;
    const double nx = std::clamp(x + 0.71 * radius, disc, picture.width - disc);
    const double ny = std::clamp(y - 0.71 * radius, disc, picture.height - disc);
    fillBox(picture, {nx - disc, ny - disc, 2 * disc, 2 * disc}, {kPaper.color, 0.95f}, disc);
    drawText(picture, nx - 0.5 * textWidth(number, style), ny + 0.35 * style.size, number, style);
  }
}

void Sheet::addName(const Cell& cell, Side side, bool right, Pixels& picture) const {
  const TextStyle style{.size = 1.25 * layout_.text, .weight = kBold, .ink = kBright};
  const double margin = 0.7 * layout_.text, width = chipWidth(text_.names[side], style);
  const double x = right ? cell.x + cell.width - margin - width : cell.x + margin;
  chip(x, cell.y + margin, text_.names[side], style, picture);
}

void Sheet::addCloser(std::size_t at, Side side, const Pixels& piece, Pixels& picture) const {
  const Cell& cell = layout_.closer[at][side == Side::plain ? 0 : 1];
  place(piece, cell.x, cell.y, picture);
  const double margin = 0.45 * layout_.text;
  const TextStyle style{.size = 0.85 * layout_.text, .ink = kBright};
  double x = cell.x + margin;
  if (layout_.closer.size() > 1 && side == Side::plain) {
    const TextStyle number{.size = style.size, .weight = kBold, .ink = kAccent};
    chip(x, cell.y + margin, fmt::format("{}", at + 1), number, picture);
    x += chipWidth(fmt::format("{}", at + 1), number) + 0.3 * layout_.text;
  }
  if (x + chipWidth(text_.names[side], style) < cell.x + cell.width - margin)
    chip(x, cell.y + margin, text_.names[side], style, picture);
}

void Sheet::addFigures(const Moment& moment, Pixels& picture) const {
  FigureTable(text_, moment).draw(layout_.figures, layout_.text, picture);
}

}  // namespace fascia
