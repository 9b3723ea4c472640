-- A scene in Neovim: diagnostics, a code action, completion, hover, rename and formatting.
-- Started by tests/lsp.rs with $STRAHL and $FOLDER.

local PATIENCE = 20000
local path = vim.env.FOLDER .. '/scene.' .. vim.env.ENDING

local function fail(message)
  io.stderr:write(message .. '\n')
  vim.cmd('cquit 1')
end

local function expect(what, found, expected)
  if not vim.deep_equal(found, expected) then
    fail(what .. ': expected ' .. vim.inspect(expected) .. ', found ' .. vim.inspect(found))
  end
end

local function main()
  vim.cmd('edit ' .. vim.fn.fnameescape(path))
  vim.bo.filetype = vim.env.ENDING
  local buffer = vim.api.nvim_get_current_buf()
  local id = vim.lsp.start_client({
    name = 'strahl',
    cmd = { vim.env.STRAHL, 'lsp' },
    root_dir = vim.env.FOLDER,
  })
  vim.lsp.buf_attach_client(buffer, id)
  local client = vim.lsp.get_client_by_id(id)
  if not vim.wait(PATIENCE, function() return client.initialized end, 10) then
    fail('the server does not answer')
  end

  local function text()
    return table.concat(vim.api.nvim_buf_get_lines(buffer, 0, -1, true), '\n') .. '\n'
  end
  local function codes()
    local found = {}
    for _, diagnostic in ipairs(vim.diagnostic.get(buffer)) do
      table.insert(found, diagnostic.code or diagnostic.user_data.lsp.code)
    end
    table.sort(found)
    return found
  end
  local function wait_for(expected)
    vim.wait(PATIENCE, function() return vim.deep_equal(codes(), expected) end, 10)
    expect('diagnostics', codes(), expected)
  end
  -- Puts the cursor on the first place of a word.
  local function go_to(word)
    vim.api.nvim_win_set_cursor(0, { 1, 0 })
    if vim.fn.search('\\V' .. word, 'c') == 0 then
      fail(word .. ' is missing in ' .. text())
    end
  end
  local function ask(method, more)
    local params = vim.lsp.util.make_position_params(0, client.offset_encoding)
    params = vim.tbl_extend('force', params, more or {})
    local answers, problem = vim.lsp.buf_request_sync(buffer, method, params, PATIENCE)
    local answer = answers and answers[id]
    if not answer or answer.error then
      fail(method .. ': ' .. vim.inspect(answer) .. (problem or ''))
    end
    return answer.result
  end

  -- Diagnostics, and the fix of one.
  wait_for({ 'out-of-range', 'unknown-field' })
  go_to('radus')
  local range = vim.lsp.util.make_range_params(0, client.offset_encoding).range
  local actions = ask('textDocument/codeAction', { range = range, context = { diagnostics = {} } })
  vim.lsp.util.apply_workspace_edit(actions[1].edit, client.offset_encoding)
  wait_for({ 'out-of-range' })

  -- Diagnostics follow what is typed.
  go_to('400')
  vim.cmd('normal! cw60')
  wait_for({})

  -- Completion at the end of a new line.
  go_to('camera')
  vim.cmd('normal! O' .. vim.env.BEGIN)
  local column = #vim.api.nvim_get_current_line()
  vim.api.nvim_win_set_cursor(0, { vim.fn.line('.'), column })
  local found = ask('textDocument/completion', {
    position = { line = vim.fn.line('.') - 1, character = column },
  })
  local labels = {}
  for _, item in ipairs(found.items) do
    labels[item.label] = item
  end
  local item = labels['background']
  if not item then
    fail('no completion: ' .. vim.inspect(found))
  end
  vim.lsp.util.apply_text_edits({ item.textEdit }, buffer, client.offset_encoding)
  vim.api.nvim_set_current_line(vim.api.nvim_get_current_line() .. '"#ff0000",')
  wait_for({})

  -- Hover.
  go_to('fov')
  local hover = ask('textDocument/hover')
  if not hover.contents.value:find('above 0, below 180') then
    fail('hover: ' .. vim.inspect(hover))
  end

  -- Rename.
  go_to('gold')
  local edit = ask('textDocument/rename', { newName = 'brass' })
  vim.lsp.util.apply_workspace_edit(edit, client.offset_encoding)
  wait_for({})
  local _, count = text():gsub('brass', '')
  expect('the places of the name', count, 2)

  -- Formatting.
  if vim.lsp.buf.format then
    vim.lsp.buf.format({ timeout_ms = PATIENCE })
  else
    vim.lsp.buf.formatting_sync(nil, PATIENCE)
  end
  vim.cmd('write')
  wait_for({})

  vim.lsp.stop_client(id)
  vim.wait(PATIENCE, function() return client.is_stopped() end, 10)
  vim.cmd('qall!')
end

local done, problem = pcall(main)
if not done then
  fail(tostring(problem))
end
