#include <fascia/io/documents/body_codec.h>

#include <algorithm>

namespace fascia {
namespace {

class BodyBasisCodec final : public Codec<BodyBasisDef> {
 public:
  void read(const Json& json, const JsonPath& path, Reading& reading,
            BodyBasisDef& value) const override {
    BodyBasisDef read;
    const bool isObject = json.is(Json::Kind::object) && json.object().size() == 1;
    if (json.is(Json::Kind::text) && json.text() == "affine") {
      value = read;
    } else if (json.is(Json::Kind::text) && json.text() == "quadratic") {
      read.kind = BodyBasisDef::Kind::polynomial;
      value = read;
    } else if (const Json* order = isObject ? json.find("polynomial") : nullptr) {
      read.kind = BodyBasisDef::Kind::polynomial;
      order_->read(*order, path["polynomial"], reading, read.order);
      value = read;
    } else if (const Json* cells = isObject ? json.find("lattice") : nullptr) {
      read.kind = BodyBasisDef::Kind::lattice;
      if (readCells(*cells, path["lattice"], reading, read.cells)) value = read;
    } else {
      reading.unexpected(json, path, kExpected);
    }
  }

  Json write(const BodyBasisDef& value) const override {
    Json out;
    if (value.kind == BodyBasisDef::Kind::affine) return "affine";
    if (value.kind == BodyBasisDef::Kind::lattice) {
      Json::List cells;
      for (const int count : value.cells) cells.push_back(order_->write(count));
      out.set("lattice", std::move(cells));
    } else if (value.order == BodyBasisDef{}.order) {
      return "quadratic";
    } else {
      out.set("polynomial", order_->write(value.order));
    }
    return out;
  }

  Json schema() const override {
    Json word, polynomial, lattice, cells;
    word.set("enum", Json::List{"affine", "quadratic"});
    cells.set("type", "array");
    cells.set("minItems", 2);
    cells.set("maxItems", 3);
    cells.set("items", cells_->schema());
    polynomial = only("polynomial", order_->schema());
    lattice = only("lattice", std::move(cells));
    Json out;
    out.set("anyOf", Json::List{std::move(word), std::move(polynomial), std::move(lattice)});
    return out;
  }

  bool same(const BodyBasisDef& a, const BodyBasisDef& b) const override { return a == b; }

 private:
  static constexpr const char* kExpected =
      "\"affine\", \"quadratic\", {\"polynomial\": order} or {\"lattice\": [x, y, z]}";

  bool readCells(const Json& json, const JsonPath& path, Reading& reading,
                 Eigen::Vector3i& cells) const {
    if (!json.is(Json::Kind::list) || json.list().size() < 2 || json.list().size() > 3) {
      reading.unexpected(json, path, "two or three numbers of cells");
      return false;
    }
    for (std::size_t axis = 0; axis < json.list().size(); ++axis)
      cells_->read(json.list()[axis], path[axis], reading, cells[static_cast<Eigen::Index>(axis)]);
    return true;
  }
  static Json only(const char* key, Json value) {
    Json properties, out;
    properties.set(key, std::move(value));
    out.set("type", "object");
    out.set("properties", std::move(properties));
    out.set("required", Json::List{key});
    out.set("additionalProperties", false);
    return out;
  }

  CodecPtr<int> order_ = integers(kBasisOrder.range), cells_ = integers(kBasisCells.range);
};

}  // namespace

CodecPtr<BodyBasisDef> bodyBasisCodec() {
  return std::make_shared<BodyBasisCodec>();
}

}  // namespace fascia
