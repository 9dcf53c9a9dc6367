-- round_trip.lua SAMPLES OUT NAME...: decode each sample, encode it again. The generated modules, and
-- lcm.lua beside this file, are in LUA_PATH.

-- A global of Lua 5.1, which the code of lcm-gen 1.3 uses.
unpack = unpack or table.unpack

local samples, out = arg[1], arg[2]

local function open(folder, name, mode)
  return assert(io.open(folder .. "/" .. name, mode))
end

for i = 3, #arg do
  local name = arg[i]
  local sample = open(samples, name, "rb")
  local message = require(name).decode(sample:read("a"))
  sample:close()
  local copy = open(out, name, "wb")
  copy:write(message:encode())
  copy:close()
end
