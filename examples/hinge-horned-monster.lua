-- A humanoid comes hopping along, led by its head like a marionette.
local walk = start(function()
  while true do
    local x = position("man.head").x
    move("man.head", {x + 0.14, 0.8}, 0.16)
    move("man.head", {x + 0.28, 0.72}, 0.16)
    wait(0.1)
  end
end)

-- The monster lies in wait: horn raised, mouth open.
for _, point in ipairs {"horn.elbow", "spike.tip", "jaw.tip"} do hold(point) end
wait_for(function() return distance("man.middle", "monster.brow") < 1.75 end)

-- Skewer.
release("horn.elbow")
grab("spike.tip", "man.middle", 0.35)
cancel(walk)
release("man.head")

-- Bring the elbow to a good spot and the catch to where it can be flung from.
local brow = position("monster.brow")
parallel(
  function() move("horn.elbow", brow + vec(-0.8, 0.5), 0.9) end,
  function() move("man.middle", brow + vec(-1.5, 0.0), 0.9) end)
wait(0.2)

-- Fling: a thrown body flies from `mouth` to the throat in `flight` seconds.
local flight = 0.25
local mouth, throat = brow + vec(-0.9, -0.45), position("monster.throat")
local throw = (throat - mouth) / flight + gravity() * (-flight / 2)
release("horn.elbow")
move("man.middle", mouth, 0.3, throw)
release("man.middle")
stop("spike.tip")

-- It pops into the gaping jaws by itself; they close.
local fed = wait_for(function() return distance("man.middle", "monster.throat") < 0.2 end, 1)
if not fed then fail("missed the mouth") end
parallel(
  function() grab("man.middle", "monster.throat", 0.1) end,
  function() move("jaw.tip", position("jaw.tip") + vec(0.1, 0.36), 0.15) end)
move("horn.elbow", brow + vec(0.1, 0.95), 0.8)
wait(0.5)
succeed()
