-- The two lines of the paper's figure 3. Everything else follows by itself.
grab("hook.bend", "pyramid.ring", 1.2)
grab("hook.eye", "sky", 1.6)

wait(2)
if connected("hook.eye", "sky") and distance("pyramid.ring", "hook.bend") < 0.01
   and position("pyramid.middle").y > 0.8 then
  succeed()
else
  fail("the pyramid does not hang")
end
