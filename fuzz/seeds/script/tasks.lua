local task = start(function() while true do push("b", {0, 1}, 0.1) wait(0.1) end end)
follow("a", {{0, {0, 0}}, {0.2, {1, 1}, {1, 0}, {0, 1}}, {time = 0.3, at = position("p")}}, {preroll = 0.1})
for key, value in pairs({x = 1, y = 2}) do log(key, value, velocity("a"):length(), time()) end
pull("a", "p", 10, 1) hold("b") stop("b") impulse("b", {random(), random(-1, 1)})
table.sort({3, 1, 2}, function(m, n) return m > n end)
cancel(task) connect("a", "b") log(connected("a", "b"), running(task), string.format("%5.1f", 2))
if time() > 1 then fail("late") else succeed() end
