---@meta
-- What Fascia's scripts can call: for completion and checks in editors (LuaLS). Generated from the
-- functions themselves; docs/scripting.md explains them.

---A vector: m, m/s or N. Its numbers do not change.
---@class vec
---@field x number
---@field y number
---@field z number
---@operator add(vec): vec
---@operator sub(vec): vec
---@operator mul(number): vec
---@operator div(number): vec
---@operator unm: vec
local vec_methods = {}
---@return number
function vec_methods:length() end
---@return vec
function vec_methods:normalized() end
---@param other vec
---@return number
function vec_methods:dot(other) end
---@param other vec
---@return vec
function vec_methods:cross(other) end

---A vec, {x, y} or {x, y, z}.
---@alias place vec|number[]

---The name of a point, or a place.
---@alias target string|place

---One place of a path, as {time, at, velocity, velocity_out} or with these names.
---@class key
---@field time? number seconds after the onset
---@field at? place m
---@field velocity? place m/s; by default that of the smooth path through all keys
---@field velocity_out? place after this key, if the velocity jumps there
---@field [integer] number|place

---@class follow_options
---@field preroll? number seconds to lead the point to the path; 0.25 by default
---@field onset? number time() at which the path starts; by default after the preroll

---What start() gives.
---@class task

---Chases the target and connects to it on arrival.
---@param point string a point of a body, by its name
---@param target target another point, which may move, or a place
---@param seconds number how long it takes
---@param velocity? place of the point on arrival, m/s; by default one that is easy to reach
---@return boolean # whether it got there; a newer call for the same point ends an older one
function grab(point, target, seconds, velocity) end

---Takes the point to where the target will be, and lets it fly on from there.
---@param point string a point of a body, by its name
---@param target target another point, which may move, or a place
---@param seconds number how long it takes
---@param velocity? place of the point on arrival, m/s; by default one that is easy to reach
---@return boolean # whether it got there; a newer call for the same point ends an older one
function chase(point, target, seconds, velocity) end

---Takes the point to a place and holds it there.
---@param point string a point of a body, by its name
---@param place target where to; of a moving point, where it is now
---@param seconds number how long it takes
---@param velocity? place on arrival, m/s; the point is let go then
---@return boolean # whether it got there; a newer call for the same point ends an older one
function move(point, place, seconds, velocity) end

---Leads the point along a smooth path through keys; holds it at the end if the path ends at rest, otherwise lets it go. Before, a preroll takes it from where it is to the path.
---@param point string a point of a body, by its name
---@param keys key[] places at growing times, in seconds after the onset
---@param options? follow_options preroll and onset
---@return boolean # whether it went all the way
function follow(point, keys, options) end

---Waits.
---@param seconds number 0 waits for the next step
function wait(seconds) end

---Waits until a condition holds.
---@param condition fun(): boolean asked before every step
---@param timeout? number seconds after which it gives up
---@return boolean # whether the condition holds
function wait_for(condition, timeout) end

---Runs functions at the same time, and waits until all have ended.
---@param ... fun() what to do
function parallel(...) end

---Ties the point to the target: an impulse makes their velocities one, and what distance there is closes within a tenth of a second.
---@param point string a point of a body, by its name
---@param target target a point of another body, or a place to nail it to
function connect(point, target) end

---Holds the point where it is.
---@param point string a point of a body, by its name
function hold(point) end

---Lets the point go from everything that holds, leads, ties or pulls it; it flies on.
---@param point string a point of a body, by its name
---@param other? string only from this point
function release(point, other) end

---Stops the point dead by an impulse, and lets it go.
---@param point string a point of a body, by its name
function stop(point) end

---A blow on the point.
---@param point string a point of a body, by its name
---@param impulse place N s
function impulse(point, impulse) end

---Pushes the point with a force for a time.
---@param point string a point of a body, by its name
---@param force place N
---@param seconds number how long; the call does not wait
function push(point, force, seconds) end

---Pulls the point to the target by a damped spring, until it is released.
---@param point string a point of a body, by its name
---@param target target another point or a place; call again to move it
---@param stiffness number N/m
---@param damping? number N s/m; 0 by default
function pull(point, target, stiffness, damping) end

---Starts a function that runs at the same time as what follows.
---@param task fun() what to do
---@return task # the task
function start(task) end

---Ends a task where it is; what it was leading is let go.
---@param task task from start()
function cancel(task) end

---Tells whether a task goes on.
---@param task task from start()
---@return boolean # whether it has not ended yet
function running(task) end

---Ends the script: it has done what it was to do.
function succeed() end

---Ends the script: it has failed.
---@param reason? string what went wrong
function fail(reason) end

---Where a point is.
---@param point string any point
---@return vec # m
function position(point) end

---How fast it is.
---@param point string any point
---@return vec # m/s
function velocity(point) end

---How far two points or places are apart.
---@param a target a point or a place
---@param b target another one
---@return number # m
function distance(a, b) end

---Tells whether connect() or grab() has tied two points, or one to a place.
---@param a string a point of a body
---@param b string of another one, or a place
---@return boolean # whether they are
function connected(a, b) end

---Simulated time since the start.
---@return number # s
function time() end

---What the scene's gravity accelerates bodies by.
---@return vec # m/s²
function gravity() end

---A random number; the seed of the run decides which.
---@param low? number 0 by default
---@param high? number 1 by default
---@return number # between the two
function random(low, high) end

---A vector, with + - * / ==, fields x y z, and :length() :normalized() :dot(v) :cross(v).
---@param x number
---@param y number
---@param z? number 0 by default
---@return vec # the vector
function vec(x, y, z) end

---Writes a line to the log of the run.
---@param ... any what to write
function log(...) end
