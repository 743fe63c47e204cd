#pragma once

#include <fascia/character/character_def.h>
#include <fascia/io/documents/plain_codecs.h>

namespace fascia {

// The parts of a character file, one table of fields each.
CodecPtr<JointDef> jointCodec();
CodecPtr<FleshSolidDef> solidCodec();
CodecPtr<SkinDef> skinCodec();
CodecPtr<SkinPointsDef> skinPointsCodec();
CodecPtr<MotionDef> motionCodec();
CodecPtr<SimulationDef> simulationCodec();
CodecPtr<CharacterDef> characterCodec();

CodecPtr<Dof> dofCodec();

// Dof values: degrees or metres in the file.
std::string dofUnit(Dof dof);  // "deg" or "m"
Json dofJson(Dof dof, double value);
bool readDofValue(Dof dof, const Json& json, const JsonPath& path, Reading& reading, double& value);

// Beyond these a file is refused: what it would cost to build grows with them.
inline constexpr std::size_t kMaxListed = 10'000;   // regions, brushes, motions, drivers …
inline constexpr std::size_t kMaxKeys = 1'000'000;  // of one track

}  // namespace fascia
