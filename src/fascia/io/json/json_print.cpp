#include <fascia/io/json/json.h>

namespace fascia {
namespace {

constexpr std::size_t kLineWidth = 100;

bool isContainer(const Json& value) {
  return value.is(Json::Kind::list) || value.is(Json::Kind::object);
}

bool isNumberList(const Json& value) {
  if (!value.is(Json::Kind::list)) return false;
  for (const Json& item : value.list()) {
    if (!item.is(Json::Kind::number)) return false;
  }
  return true;
}

// What stands between the parts of a value on one line.
struct Separators {
  const char *item, *member;
};
constexpr Separators kSpaced{", ", ": "}, kDense{",", ":"};
constexpr std::size_t kAnyLength = static_cast<std::size_t>(-1);

// Appends the value on one line; gives up (false) once `out` exceeds `limit` characters.
bool printOnOneLine(const Json& value, const Separators& between, std::size_t limit,
                    std::string& out) {
  switch (value.kind()) {
    case Json::Kind::null:
      out += "null";
      break;
    case Json::Kind::boolean:
      out += value.boolean() ? "true" : "false";
      break;
    case Json::Kind::number:
      out += value.digits();
      break;
    case Json::Kind::text:
      out += jsonText(value.text());
      break;
    case Json::Kind::list: {
      out += '[';
      for (const Json& item : value.list()) {
        if (&item != value.list().data()) out += between.item;
        if (!printOnOneLine(item, between, limit, out)) return false;
      }
      out += ']';
      break;
    }
    case Json::Kind::object: {
      out += '{';
      for (const Json::Member& member : value.object()) {
        if (&member != value.object().data()) out += between.item;
        out += jsonText(member.key) + between.member;
        if (!printOnOneLine(member.value, between, limit, out)) return false;
      }
      out += '}';
      break;
    }
  }
  return out.size() <= limit;
}

class Printer {
 public:
  std::string out;

  void print(const Json& value, std::size_t indent, std::size_t used, bool root) {
    if (!isContainer(value) || isNumberList(value)) {
      printOnOneLine(value, kSpaced, kAnyLength, out);
      return;
    }
    std::string line;
    const std::size_t room = used + 1 < kLineWidth ? kLineWidth - used - 1 : 0;
    if (!root && printOnOneLine(value, kSpaced, room, line)) {
      out += line;
      return;
    }
    printOnManyLines(value, indent);
  }

 private:
  void printOnManyLines(const Json& value, std::size_t indent) {
    const bool list = value.is(Json::Kind::list);
    const std::string margin(indent + 2, ' ');
    out += list ? "[" : "{";
    bool first = true;
    const auto start = [&] {
      out += first ? "\n" : ",\n";
      out += margin;
      first = false;
    };
    if (list) {
      for (const Json& item : value.list()) {
        start();
        print(item, indent + 2, indent + 2, false);
      }
    } else {
      for (const Json::Member& member : value.object()) {
        start();
        const std::string key = jsonText(member.key) + ": ";
        out += key;
        print(member.value, indent + 2, indent + 2 + key.size(), false);
      }
    }
    out += '\n' + std::string(indent, ' ') + (list ? "]" : "}");
  }
};

}  // namespace

std::string compactJson(const Json& value) {
  std::string out;
  printOnOneLine(value, kDense, kAnyLength, out);
  return out;
}

std::string printJson(const Json& value) {
  Printer printer;
  printer.print(value, 0, 0, true);
  return printer.out + '\n';
}

}  // namespace fascia
