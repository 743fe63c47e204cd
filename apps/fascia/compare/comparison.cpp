#include "compare/comparison.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <fascia/base/parallel.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/picture/video_writer.h>

#include "compare/shooting.h"
#include "compare/subject.h"
#include "film_parts.h"
#include "outputs.h"
#include "progress.h"

namespace fascia {
namespace {

constexpr double kLooks_hz = 15;          // a still's moment is chosen among so many per second
constexpr std::size_t kMostReaches = 40;  // moments that a film's camera is framed by
constexpr double kWipe_s = 4;             // in which the line goes once to and fro
constexpr double kWipeReach = 0.38;       // of the picture, to either side of its middle

void checkOptions(const CompareOptions& options) {
  checkFolders({options.output});
  checkOverwriting({options.output}, {});
  if (options.film() && options.time_s >= 0)
    throw Error("--time is of a picture (.png); a film shows the whole motion");
  if (!options.film() && options.turntable)
    throw Error("--turntable is of a film (.mp4 or .gif); --camera turns a picture");
}

// From the first option to the last line.
class Comparison {
 public:
  Comparison(CompareOptions& options, const Console& console)
      : options_(options),
        console_(console),
        subject_(prepare()),
        sides_(subject_.character, subject_.recording, options.against),
        surveyor_(std::make_unique<Surveyor>(sides_, options.worst)) {}

  void run() {
    chooseFrames();
    survey();
    findReach();
    choosePlaces();
    Shooting shooting(sides_, MainView(spec_, reach_, options_.turntable), places_, makeSheet(),
                      makeSetting());
    if (options_.film())
      shootFilm(shooting);
    else
      shootPicture(shooting);
    report();
  }

 private:
  using Points = std::vector<Eigen::Vector3f>;

  Subject prepare() {
    // Frames of the film are frames of the simulation, with none between that are not evenly so.
    constexpr double kUsual_hz = 60;
    if (options_.film())
      options_.simulation.frame_rate_hz =
          options_.rate_hz() * std::max(1.0, std::ceil(kUsual_hz / options_.rate_hz() - 1e-6));
    return prepareSubject(
        options_.input, options_.simulation,
        options_.time_s >= 0 ? std::optional<double>(options_.time_s) : std::nullopt, console_);
  }

  void chooseFrames() {
    const double start_s = sides_.time_s(0);
    const double length_s = sides_.time_s(sides_.frameCount() - 1) - start_s;
    if (options_.time_s >= 0) {
      frames_ = {sides_.closestTo(options_.time_s)};
      return;
    }
    const double rate_hz = options_.film() ? options_.rate_hz() : kLooks_hz;
    const auto count =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(length_s * rate_hz)));
    for (std::size_t i = 0; i < count; ++i)
      frames_.push_back(sides_.closestTo(start_s + static_cast<double>(i) / rate_hz));
    // A recording may hold fewer frames than are looked at.
    if (!options_.film()) frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
  }

  std::vector<Moment> lookAtAll() {
    ProgressBar progress(console_, "measuring");
    return surveyor_->look(frames_, [&](double share) { progress.update(share); });
  }

  void survey() {
    moments_ = lookAtAll();
    worst_ = worstOf(moments_);
    if (!(moments_[worst_].badness > 0) && options_.worst != Worst::difference) {
      // Nothing is wrong anywhere: where do the sides differ?
      surveyor_ = std::make_unique<Surveyor>(sides_, Worst::difference);
      moments_ = lookAtAll();
      worst_ = worstOf(moments_);
    }
    worstMoment_ = surveyor_->look(frames_[worst_]);
    for (const Side side : kSides) sides_.points(worstMoment_.frame, side, worstPoints_[side]);
  }

  // All that the camera has to show.
  void findReach() {
    path_.assign(sides_.frameCount(), Vec3::Zero());
    if (!options_.film()) {
      for (const Side side : kSides)
        for (const Eigen::Vector3f& p : worstPoints_[side]) reach_.add(p.cast<double>());
      return;
    }
    if (!options_.stand) path_ = pathOf(sides_);
    const std::size_t step = 1 + (frames_.size() - 1) / kMostReaches;
    Points points;
    for (std::size_t i = 0; i < frames_.size(); i += step)
      for (const Side side : kSides) {
        sides_.points(frames_[i], side, points);
        for (const Eigen::Vector3f& p : points) reach_.add(p.cast<double>() - path_[frames_[i]]);
      }
  }

  void choosePlaces() {
    places_ = findPlaces(sides_.model(), worstMoment_, worstPoints_, options_.places());
    spec_ = parseCamera(options_.camera.empty() ? "three-quarter" : options_.camera);
    if (options_.camera.empty() && !options_.turntable) {
      std::vector<CameraSpec> specs;
      std::vector<Vec3> directions;
      for (const char* view : {"az=32,el=9", "az=-32,el=9", "az=62,el=9", "az=-62,el=9"}) {
        specs.push_back(parseCamera(view));
        directions.push_back(MainView(specs.back(), reach_, false).towards());
      }
      spec_ = specs[chooseView(sides_.model(), worstPoints_, places_, directions)];
    }
    chooseViews(sides_.model(), worstPoints_, MainView(spec_, reach_, false).towards(), places_);
  }

  Sheet makeSheet() const {
    const MainView view(spec_, reach_, options_.turntable);
    const auto distance = [&](double aspect) {
      const Camera camera = view.camera(aspect, 0, Vec3::Zero());
      return (camera.eye_m - camera.target_m).norm();
    };
    const Size size = options_.pictureSize();
    return Sheet(arrange(size.width, size.height, places_.size(), options_.wipe, distance),
                 {{sides_.name(Side::plain), sides_.name(Side::ours)}, {}});
  }

  Setting makeSetting() const {
    const Character& character = subject_.character;
    const std::string& motion = subject_.recording.motion;
    const Reach reach = motionReach(
        character, character.source(motion.empty() ? -1 : character.findMotion(motion)));
    return {rigSurface(character, console_), reach.box(), floorHeight(character, reach)};
  }

  std::string title(std::size_t frame) const {
    return fmt::format("{}, {:.2f} s", subject_.recording.motion, sides_.time_s(frame));
  }

  static void toImage(const Pixels& pixels, Image& image) {
    image.width = pixels.width;
    image.height = pixels.height;
    image.rgba = pixels.rgba;
  }

  void shootPicture(Shooting& shooting) {
    Image image;
    toImage(shooting.draw({.frame = worstMoment_.frame}, worstMoment_, title(worstMoment_.frame)),
            image);
    writePng(image, options_.output);
  }

  void shootFilm(Shooting& shooting) {
    const Size size = options_.pictureSize();
    VideoWriter video(options_.output, size.width, size.height,
                      {.frame_rate_hz = options_.rate_hz()});
    ProgressBar progress(console_, "drawing");
    const auto count = static_cast<double>(frames_.size());
    const double wipes = std::max(1.0, std::round(count / options_.rate_hz() / kWipe_s));
    Image image;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const double share = static_cast<double>(i) / count;
      const FilmPicture shot{.frame = frames_[i],
                             .turn = share,
                             .wipe = 0.5 + kWipeReach * std::sin(2 * kPi * wipes * share),
                             .gone = path_[frames_[i]]};
      toImage(shooting.draw(shot, moments_[i], title(frames_[i])), image);
      video.add(image);
      progress.update((static_cast<double>(i) + 1) / count);
    }
    video.finish();
    if (!video.hint().empty()) console_.hint(video.hint());
  }

  Json figures(const ClipFigures& all, Side side) const {
    return Json::Object{{"name", sides_.name(side)},
                        {"new_crossings", static_cast<int>(all.crossings[side])},
                        {"turned_triangles", static_cast<int>(all.turned[side])},
                        {"stretch_percentile99", all.stretch[side]}};
  }

  void report() const {
    const ClipFigures all = figuresOf(moments_);
    const std::string where = options_.film() ? "" : ": " + title(worstMoment_.frame);
    console_.say("wrote " + options_.output + where);
    const auto line = [&](const char* what, const std::string& plain, const std::string& ours) {
      console_.say(fmt::format("{:18} {:>18} {:>9}", what, plain, ours));
    };
    line(frames_.size() > 1 ? "at worst" : "", sides_.name(Side::plain), sides_.name(Side::ours));
    line("new crossings", fmt::to_string(all.crossings.plain), fmt::to_string(all.crossings.ours));
    line("turned triangles", fmt::to_string(all.turned.plain), fmt::to_string(all.turned.ours));
    line("stretch (99 %)", fmt::format("{:.2f}", all.stretch.plain),
         fmt::format("{:.2f}", all.stretch.ours));
    console_.say(fmt::format("up to {:.1f} mm apart; worst at {:.2f} s", 1e3 * all.apart_m,
                             sides_.time_s(worstMoment_.frame)));
    console_.answer(Json::Object{{"ok", true},
                                 {"outputs", Json::List{options_.output}},
                                 {"motion", subject_.recording.motion},
                                 {"worst_s", sides_.time_s(worstMoment_.frame)},
                                 {"frames", static_cast<int>(frames_.size())},
                                 {"places", static_cast<int>(places_.size())},
                                 {"plain", figures(all, Side::plain)},
                                 {"ours", figures(all, Side::ours)},
                                 {"apart_m", all.apart_m}});
  }

  CompareOptions& options_;
  const Console& console_;
  Subject subject_;
  Sides sides_;
  std::unique_ptr<Surveyor> surveyor_;
  std::vector<std::size_t> frames_;  // of the film, or those to choose a picture's from
  std::vector<Moment> moments_;      // of those
  std::size_t worst_ = 0;
  Moment worstMoment_;
  Both<Points> worstPoints_;
  std::vector<Vec3> path_;  // of the camera, by frame of the recording
  Reach reach_;
  CameraSpec spec_;
  std::vector<Place> places_;
};

}  // namespace

bool CompareOptions::film() const {
  return endingOf(output) != ".png";
}

Size CompareOptions::pictureSize() const {
  const std::string usual = !film()                      ? "1600x900"
                            : endingOf(output) == ".gif" ? "800x450"
                                                         : "1280x720";
  return parseSize(size.empty() ? usual : size);
}

std::size_t CompareOptions::places() const {
  return static_cast<std::size_t>(zooms >= 0 ? zooms : film() ? 1 : 3);
}

double CompareOptions::rate_hz() const {
  return frame_rate_hz > 0 ? frame_rate_hz : endingOf(output) == ".gif" ? 20 : 30;
}

void compare(CompareOptions& options, const Console& console) {
  checkOptions(options);
  const ThreadLimit threads(options.simulation.threads);
  Comparison(options, console).run();
}

}  // namespace fascia
