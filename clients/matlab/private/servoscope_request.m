function text = servoscope_request(method, path, body, patience_s)
%SERVOSCOPE_REQUEST  Sends a request and gives the text of the answer.
%   BODY is a struct with the fields json (text), or parts: a cell array with
%   rows {name, value, is_file} of a form; empty for none. PATIENCE_S is how
%   many seconds the server may take.
%
%   A POST carries an idempotency key, so that curl may repeat it.
%
%   curl reads its arguments from a file: nothing of them passes a shell, and
%   no key shows in the list of processes.
    server = servoscope_server();
    folder = private_folder();
    files = struct( ...
        'settings', fullfile(folder, 'settings'), ...
        'answer', fullfile(folder, 'answer'), ...
        'body', fullfile(folder, 'body'));
    cleaner = onCleanup(@() remove(folder, struct2cell(files)));
    lines = {'silent', 'show-error', 'retry = 5', 'retry-connrefused', ...
        option('request', method), ...
        option('url', [server.url path]), ...
        option('output', files.answer), ...
        option('write-out', '%{http_code}'), ...
        'connect-timeout = 10', ...
        sprintf('max-time = %d', ceil(patience_s) + 30)};
    if ~isempty(server.api_key)
        lines{end + 1} = option('header', ['Authorization: Bearer ' server.api_key]);
    end
    if strcmp(method, 'POST')
        lines{end + 1} = option('header', ['Idempotency-Key: ' new_key()]);
    end
    if isfield(body, 'json')
        write(files.body, body.json);
        lines{end + 1} = option('header', 'Content-Type: application/json');
        lines{end + 1} = option('data-binary', ['@' files.body]);
    end
    if isfield(body, 'parts')
        for i = 1:size(body.parts, 1)
            lines{end + 1} = part(body.parts{i, :});
        end
    end
    write(files.settings, sprintf('%s\n', lines{:}));
    [failed, printed] = system([curl() ' --config ' for_shell(files.settings) ' 2>&1']);
    if failed
        error('servoscope:unreachable', 'the server at %s does not answer: %s', ...
            server.url, strtrim(printed));
    end
    text = '';
    if exist(files.answer, 'file')
        text = read(files.answer);
    end
    status = str2double(regexp(printed, '\d{3}$', 'match', 'once'));
    if isnan(status) || status >= 400
        fail(status, text);
    end
end

function command = curl()
    command = 'curl';
    if isunix()
        % MATLAB puts libraries of its own before those that curl needs.
        command = 'env -u LD_LIBRARY_PATH curl';
    end
end

function folder = private_folder()
    % The settings may hold a key, which no other user may read.
    folder = tempname();
    if isunix()
        failed = system(['mkdir -m 700 ' for_shell(folder)]);
    else
        failed = ~mkdir(folder);
    end
    if failed
        error('servoscope:file', 'cannot make the folder %s', folder);
    end
end

function text = for_shell(path)
    if isunix()
        text = ['''' strrep(path, '''', '''\''''') ''''];
    else
        text = ['"' path '"'];
    end
end

function line = option(name, value)
    line = [name ' = ' quoted(value)];
end

function line = part(name, value, is_file)
    if is_file
        [~, stem, extension] = fileparts(value);
        content = ['file=@' quoted(value) ';filename=' quoted([stem extension])];
        line = option('form', content);
    else
        line = option('form-string', [name '=' value]);
    end
end

function text = quoted(text)
    if any(text == 10 | text == 13 | text == 0)
        error('servoscope:argument', 'a text has a line break, which cannot be sent');
    end
    text = ['"' strrep(strrep(text, '\', '\\'), '"', '\"') '"'];
end

function fail(status, text)
    title = sprintf('HTTP status %g', status);
    kind = 'problem';
    detail = text;
    try
        problem = jsondecode(text);
        title = problem.title;
        detail = problem.detail;
        kind = regexprep(regexprep(problem.type, '.*:', ''), '[^A-Za-z0-9]', '_');
    catch
        % The answer is no problem document; its text is shown.
    end
    error(['servoscope:' kind], '%s: %s', title, detail);
end

function key = new_key()
    [~, unique] = fileparts(tempname());
    key = sprintf('%s-%.0f', unique, now() * 86400e6);
end

function write(path, text)
    file = fopen(path, 'w', 'n', 'UTF-8');
    if file < 0
        error('servoscope:file', 'cannot write %s', path);
    end
    fwrite(file, text, 'char');
    fclose(file);
end

function text = read(path)
    file = fopen(path, 'r', 'n', 'UTF-8');
    text = fread(file, [1 Inf], '*char');
    fclose(file);
end

function remove(folder, paths)
    for i = 1:numel(paths)
        if exist(paths{i}, 'file')
            delete(paths{i});
        end
    end
    rmdir(folder);
end
