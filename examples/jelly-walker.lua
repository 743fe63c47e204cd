-- A jelly that walks: a trot, two feet at a time. Only the feet have goals.
local feet = {"left_front.foot", "right_front.foot", "left_hind.foot", "right_hind.foot"}
for _, foot in ipairs(feet) do hold(foot) end
wait(0.6)

-- One foot, up and forward to its next print.
local function stride(foot, length, seconds)
  local from = position(foot)
  local forward = vec(0, 0, length)
  move(foot, from + forward * 0.5 + vec(0, 0.14, 0), seconds / 2, forward * (1.5 / seconds))
  move(foot, from + forward, seconds / 2)
end

local function trot(length, seconds)
  parallel(function() stride("left_front.foot", length, seconds) end,
           function() stride("right_hind.foot", length, seconds) end)
  parallel(function() stride("right_front.foot", length, seconds) end,
           function() stride("left_hind.foot", length, seconds) end)
end

trot(0.12, 0.3)
for _ = 1, 7 do trot(0.24, 0.3) end
trot(0.12, 0.3)

-- It has arrived: a bow.
pull("jelly.nose", position("jelly.nose") + vec(0, -0.25, 0.1), 1500, 60)
wait(0.5)
release("jelly.nose")
wait(0.8)
if position("jelly.crown").y > 0.7 and position("jelly.crown").z > 1.4 then
  succeed()
else
  fail("it has not come far, or lies on its belly")
end
