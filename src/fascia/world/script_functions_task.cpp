#include <utility>

#include <fascia/world/script_call.h>

// Tasks, and how a script ends.

namespace fascia {
namespace {

constexpr const char* kTaskType = "task";

int taskNumber(const ScriptCall& call, int i) {
  const auto* id = static_cast<const int*>(luaL_testudata(call.L, i, kTaskType));
  if (!id) refuseValue(call.L, i, "task", "what start() gave");
  return *id;
}

int start(ScriptCall& call) {
  call.checkFunction(1);
  const int id = call.host.startTask(call.L, 1);
  *static_cast<int*>(lua_newuserdatauv(call.L, sizeof(int), 0)) = id;
  luaL_newmetatable(call.L, kTaskType);
  lua_setmetatable(call.L, -2);
  return 1;
}

int cancel(ScriptCall& call) {
  const int id = taskNumber(call, 1);
  call.host.cancelTask(id);
  // A task that ends itself does not come back from here.
  return call.host.current().finished ? lua_yield(call.L, 0) : 0;
}

int running(ScriptCall& call) {
  lua_pushboolean(call.L, call.host.taskRuns(taskNumber(call, 1)) ? 1 : 0);
  return 1;
}

int succeed(ScriptCall& call) {
  call.host.end(call.L, ScriptOutcome::succeeded, {});
}

int fail(ScriptCall& call) {
  std::string reason = call.has(1) ? call.text(1) : std::string();
  call.host.end(call.L, ScriptOutcome::failed, std::move(reason));
}

}  // namespace

std::span<const ScriptFunction> taskFunctions() {
  static const std::vector<ScriptFunction> kFunctions = {
      {"start",
       {{"task", "fun()", "what to do"}},
       "task",
       "the task",
       "Starts a function that runs at the same time as what follows.",
       start},
      {"cancel",
       {{"task", "task", "from start()"}},
       "",
       "",
       "Ends a task where it is; what it was leading is let go.",
       cancel},
      {"running",
       {{"task", "task", "from start()"}},
       "boolean",
       "whether it has not ended yet",
       "Tells whether a task goes on.",
       running},
      {"succeed", {}, "", "", "Ends the script: it has done what it was to do.", succeed},
      {"fail",
       {{"reason", "string", "what went wrong", true}},
       "",
       "",
       "Ends the script: it has failed.",
       fail},
  };
  return kFunctions;
}

}  // namespace fascia
