#include <fascia/flesh/clip_source.h>

#include <fascia/flesh/bind.h>

namespace fascia {

void ClipSource::sample(double time_s, PostureSample& out) const {
  samplePosture(*clip_, *skeleton_, time_s, out.posture);
  sampleParameters(*clip_, time_s, out.parameters);
  sampleMorphs(*clip_, *morphs_, time_s, out.morphs);
}

}  // namespace fascia
