#include <fascia/deformable/contact/body_contact.h>

#include <algorithm>
#include <map>

#include <fascia/base/error.h>
#include <fascia/deformable/bases/check_range.h>
#include <fascia/deformable/contact/contact_search.h>
#include <fascia/deformable/contact/overlap_search.h>

namespace fascia {
namespace {

constexpr double kMaxFriction = 10;

BodyContacts::Pair ordered(BodyId a, BodyId b) {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

BodyContacts::BodyContacts(const BodyModel& model, const Vec3& gravity_m_per_s2,
                           const ContactSettings& settings)
    : model_(model),
      settings_(settings),
      gravity_m_per_s2_(gravity_m_per_s2.norm()),
      bodies_(model.bodyCount()),
      set_(model),
      search_(std::make_unique<ContactSearch>(*this)),
      overlaps_(std::make_unique<OverlapSearch>(*this)) {
  checkRange("contacts", "friction", settings.friction, 0, kMaxFriction);
  checkRange("contacts", "margin_m", settings.margin_m, 0, 1e3);
  checkRange("contacts", "creep_per_s", settings.creep_per_s, 1e-9, 1);
  checkRange("contacts", "points_per_body", settings.points_per_body, 1, 1000);
  if (settings.ground_m) checkRange("contacts", "ground_m", *settings.ground_m, -1e6, 1e6);
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    heaviest_kg_ = std::max(heaviest_kg_, model.shape(BodyId(b)).mass_kg());
}

BodyContacts::~BodyContacts() = default;

void BodyContacts::setSurface(BodyId body, BodySurfacePtr surface, std::optional<double> friction) {
  if (!model_.contains(body)) throw Error("contacts: found a surface of no body");
  const double mu = friction.value_or(settings_.friction);
  checkRange("contacts", "friction", mu, 0, kMaxFriction);
  bodies_[body.index()] = {std::move(surface), nullptr, mu, {}};
  changed_ = true;
}

void BodyContacts::ignorePair(BodyId a, BodyId b) {
  if (!model_.contains(a) || !model_.contains(b))
    throw Error("contacts: found a pair of no bodies");
  const auto place = std::ranges::lower_bound(ignored_, ordered(a, b));
  if (place == ignored_.end() || *place != ordered(a, b)) ignored_.insert(place, ordered(a, b));
}

void BodyContacts::collidePair(BodyId a, BodyId b) {
  std::erase(ignored_, ordered(a, b));
}

ObstacleId BodyContacts::addObstacle(const MovingField& field, std::optional<double> friction) {
  const double mu = friction.value_or(settings_.friction);
  checkRange("contacts", "friction", mu, 0, kMaxFriction);
  return obstacles_.add(field, mu);
}

ObstacleId BodyContacts::addPadding(const SurfaceField& surface, double modulus_Pa,
                                    std::optional<double> friction) {
  checkRange("contacts", "modulus_Pa", modulus_Pa, 1, 1e12);
  const double mu = friction.value_or(settings_.friction);
  checkRange("contacts", "friction", mu, 0, kMaxFriction);
  return obstacles_.addPadding(surface, modulus_Pa, mu);
}

bool BodyContacts::collides(BodyId a, BodyId b) const {
  const Pair pair = ordered(a, b);
  return !std::ranges::binary_search(ignored_, pair) && !std::ranges::binary_search(ties_, pair);
}

// Bodies of one shape with one surface share their points.
void BodyContacts::refresh() {
  if (!changed_) return;
  changed_ = false;
  std::map<std::pair<const BodyShape*, const BodySurface*>, std::shared_ptr<const ContactPoints>>
      known;
  std::vector<BodySurfacePtr> surfaces;
  std::int64_t solids = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    surfaces.push_back(body.surface);
    if (!body.surface) continue;
    const BodyShape& shape = model_.shape(BodyId(b));
    auto& points = known[{&shape, body.surface.get()}];
    if (!points)
      points = std::make_shared<ContactPoints>(makeContactPoints(
          shape, *body.surface, static_cast<std::size_t>(settings_.points_per_body)));
    body.points = points;
    body.solid = SolidId(solids++);
  }
  field_ = BodyField(model_, surfaces);
  search_->resize();
}

ContactSet& BodyContacts::find(const Step& step) {
  refresh();
  obstacles_.update(step.h_s + step.lead_s);
  const auto hasSurface = [](const Body& body) { return body.surface != nullptr; };
  const bool meet = settings_.bodies_collide && std::ranges::count_if(bodies_, hasSurface) > 1;
  if (!meet && !settings_.ground_m && obstacles_.parts().empty()) {
    set_.clear();
    set_.finish();
    return set_;
  }
  if (settings_.bodies_collide) field_.update(step.q, step.v);
  search_->find(step, field_, set_);
  return set_;
}

void BodyContacts::findOverlaps(std::span<const double> q, double leastShare,
                                std::vector<Overlap>& out) {
  overlaps_->find(q, leastShare, out);
}

}  // namespace fascia
