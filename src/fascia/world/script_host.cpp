#include <fascia/world/script_host.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fascia/world/script_call.h>

namespace fascia {
namespace {

const char kEndTag = 0;  // its address is the error that ends a script

}  // namespace

ScriptHost::ScriptHost(std::string text, std::string file, std::uint64_t seed,
                       const ScriptLimits& limits)
    : LuaSandbox(limits), file_(std::move(file)), limits_(limits), random_(seed) {
  lua_pushcfunction(main(), [](lua_State* L) {
    openScriptFunctions(L);
    return 0;
  });
  if (const int status = lua_pcall(main(), 0, 0, 0); status != LUA_OK)
    raise(issueOf(main(), status));
  load(text);
}

// The script itself is the first task.
void ScriptHost::load(const std::string& text) {
  std::string_view plain = text;  // without U+FEFF, which some editors put first
  if (plain.starts_with("\xef\xbb\xbf")) plain.remove_prefix(3);
  const int status = luaL_loadbufferx(main(), plain.data(), plain.size(), kScriptChunk, "t");
  if (status != LUA_OK) raise(issueOf(main(), status));
  const auto start = [](lua_State* L) {
    of(L).startTask(L, 1);
    return 0;
  };
  lua_pushcfunction(main(), start);
  lua_insert(main(), 1);
  if (const int failed = lua_pcall(main(), 1, 0, 0); failed != LUA_OK)
    raise(issueOf(main(), failed));
}

int ScriptHost::startTask(lua_State* L, int index) {
  if (tasks_.size() >= static_cast<std::size_t>(limits_.tasks))
    throw Error("found more than " + std::to_string(limits_.tasks) + " tasks at one time");
  auto task = std::make_unique<ScriptTask>();
  task->id = nextTask_++;
  task->thread = lua_newthread(L);
  lua_pushvalue(L, index);
  lua_xmove(L, task->thread, 1);
  task->reference = luaL_ref(L, LUA_REGISTRYINDEX);
  tasks_.push_back(std::move(task));
  return tasks_.back()->id;
}

ScriptTask* ScriptHost::findTask(int id) const {
  const auto idOf = [](const auto& task) { return task->id; };
  const auto found = std::ranges::lower_bound(tasks_, id, {}, idOf);
  return found == tasks_.end() || (*found)->id != id ? nullptr : found->get();
}

bool ScriptHost::taskRuns(int id) const {
  const ScriptTask* task = findTask(id);
  return task && !task->finished;
}

void ScriptHost::cancelTask(int id) {
  ScriptTask* task = findTask(id);
  if (!task || task->finished) return;
  task->finished = true;
  if (task->behaviour) task->behaviour->cancel(*puppet_);
  task->behaviour.reset();
  for (const int child : task->children) cancelTask(child);
}

void ScriptHost::log(std::string text) {
  if (log_.size() > static_cast<std::size_t>(limits_.log_lines)) return;
  if (log_.size() == static_cast<std::size_t>(limits_.log_lines)) text = "… and more lines";
  if (text.size() > kLongestLine) text.resize(kLongestLine), text += "…";
  log_.push_back({puppet_->time_s(), std::move(text)});
}

void ScriptHost::end(lua_State* L, ScriptOutcome outcome, std::string reason) {
  outcome_ = outcome, reason_ = std::move(reason);
  lua_pushlightuserdata(L, const_cast<char*>(&kEndTag));
  lua_error(L);
  std::abort();  // lua_error does not return, which its declaration does not say
}

void ScriptHost::update(Puppet& puppet, double h_s) {
  if (finished_) return;
  puppet_ = &puppet, step_s_ = h_s;
  beginUpdate();
  for (const auto& task : tasks_) task->waitsForStep = false;
  runTasks();
  sweep();
  if (tasks_.empty()) finished_ = true;
}

// Until all wait for the next step: what ends may be what another one waits for.
void ScriptHost::runTasks() {
  for (bool moved = true; moved && !finished_;) {
    moved = false;
    // Tasks may start others, which go to the end of the list.
    for (std::size_t i = 0; i < tasks_.size() && !finished_; ++i)
      moved = advance(*tasks_[i]) || moved;
  }
}

bool ScriptHost::waits(ScriptTask& task) {
  if (task.finished || task.waitsForStep) return true;
  if (task.behaviour) {
    const Progress progress = task.behaviour->update(*puppet_, step_s_);
    task.waitsForStep = progress == Progress::running;
    if (task.waitsForStep) return true;
    task.result = progress == Progress::done;
    task.behaviour.reset();
  }
  return std::ranges::any_of(task.children, [&](int child) { return taskRuns(child); });
}

// As far as it goes in this step; if it went at all.
bool ScriptHost::advance(ScriptTask& task) {
  bool moved = false;
  while (!finished_ && !waits(task)) {
    task.children.clear();
    resume(task);
    moved = true;
  }
  return moved;
}

void ScriptHost::resume(ScriptTask& task) {
  const int arguments = task.started ? 1 : 0;
  if (task.started) lua_pushboolean(task.thread, task.result ? 1 : 0);
  task.started = true;
  current_ = &task;
  int results = 0;
  const int status = lua_resume(task.thread, main(), arguments, &results);
  current_ = nullptr;
  if (status == LUA_YIELD) return lua_pop(task.thread, results);
  task.finished = true;
  if (status == LUA_OK) return;
  const bool ended = lua_touserdata(task.thread, -1) == &kEndTag;
  const Issue issue = ended ? Issue{} : issueOf(task.thread, status);
  finish();
  if (!ended) raise(issue);
}

void ScriptHost::sweep() {
  std::erase_if(tasks_, [&](const auto& task) {
    if (task->finished) luaL_unref(main(), LUA_REGISTRYINDEX, task->reference);
    return task->finished;
  });
}

void ScriptHost::finish() {
  finished_ = true;
  for (const auto& task : tasks_) cancelTask(task->id);
}

void ScriptHost::raise(Issue issue) {
  issue.where.file = file_;
  throw Error(std::move(issue));
}

Script::Script(std::string text, std::string file, std::uint64_t seed, const ScriptLimits& limits)
    : host_(std::make_unique<ScriptHost>(std::move(text), std::move(file), seed, limits)) {}
Script::~Script() = default;

void Script::update(Puppet& puppet, double h_s) {
  host_->update(puppet, h_s);
}
bool Script::finished() const {
  return host_->finished();
}
ScriptOutcome Script::outcome() const {
  return host_->outcome();
}
const std::string& Script::reason() const {
  return host_->reason();
}
std::span<const ScriptLogLine> Script::log() const {
  return host_->logLines();
}

}  // namespace fascia
