!> Texts of many threads at once: cases, messages, warnings and files equal those of one thread.
!>
!> Eight threads read, run and write the same cases as one thread before. Neighbouring texts differ
!> in length, so that a length shared by two threads is detected.
program test_threads
   use check, only: checks_t
   use rwmf, only: advance_stepping, case_t, create_element, create_stepping, destroy_stepping, &
      element_response_t, error_t, read_case_text, respond, result_t, simulate, stepping_t, &
      wall_element_t, write_result
   use rwmf_core_kinds, only: i8, wp
   use rwmf_text_file, only: read_file
   use rwmf_text_strings, only: integer_to_text
   implicit none

   !> Result of a task.
   type :: answer_t
      character(:), allocatable :: text
      !! message of a refused case, names or warnings of an accepted one
      real(wp), allocatable :: values(:)
      !! (n) numbers of the case or of its result [any]
   end type answer_t

   integer, parameter :: threads = 8
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: wall = '&wall h = 2, b = 0.5 / &model formulation = ''exact'' /'
   character(:), allocatable :: folder
   type(checks_t) :: checks
   integer(i8) :: ticks

   ! a unique name: builds of several kinds may be tested at the same time
   call system_clock(ticks)
   folder = 'test_threads_'//trim(integer_to_text(ticks))
   call execute_command_line('mkdir '//folder)
   call write_records()
   if (checks%wants('read')) call compare('read', 10000)
   if (checks%wants('run')) call compare('run', 400)
   if (checks%wants('step')) call compare('step', 400)
   call execute_command_line('rm -rf '//folder)
   call checks%finish()

contains

   !> Do all tasks with one thread, then with eight.
   subroutine compare(name, tasks)
      character(*), intent(in) :: name
      !! kind of task, see `do_task`
      integer, intent(in) :: tasks
      type(answer_t), allocatable :: alone(:)
      type(answer_t), allocatable :: together(:)
      integer :: different
      integer :: i

      allocate (alone(tasks), together(tasks))
      do i = 1, tasks
         call do_task(name, i, alone(i))
      end do
      !$omp parallel do num_threads(threads) schedule(dynamic, 4)
      do i = 1, tasks
         call do_task(name, i, together(i))
      end do
      !$omp end parallel do
      different = 0
      do i = 1, tasks
         if (is_same(alone(i), together(i))) cycle
         different = different + 1
         if (different <= 5) print '(3a)', alone(i)%text, nl, together(i)%text
      end do
      call checks%that(different == 0, name, trim(integer_to_text(different))//' answers differ')
      different = 0
      do i = 1, tasks - 1
         if (alone(i)%text /= alone(i + 1)%text) different = different + 1
      end do
      call checks%that(different == tasks - 1, name//': neighbours differ in the test itself')
      different = count([(allocated(alone(i)%values), i=1, tasks)])
      call checks%that(2*different == tasks, name//': half are refused', &
         trim(integer_to_text(different))//' are not')
   end subroutine compare

   !> Do one of many tasks.
   subroutine do_task(name, number, answer)
      character(*), intent(in) :: name
      integer, intent(in) :: number
      !! 1, 2, ...; every second one fails
      type(answer_t), intent(out) :: answer

      select case (name)
      case ('read')
         call read_one(number, answer)
      case ('run')
         call run_one(number, answer)
      case default
         call step_one(number, answer)
      end select
   end subroutine do_task

   !> True if two results have the same text and the same bits.
   logical function is_same(a, b)
      type(answer_t), intent(in) :: a
      type(answer_t), intent(in) :: b

      is_same = len(a%text) == len(b%text) .and. a%text == b%text &
         .and. (allocated(a%values) .eqv. allocated(b%values))
      if (.not. is_same .or. .not. allocated(a%values)) return
      is_same = all(transfer(a%values, [0_i8]) == transfer(b%values, [0_i8]))
   end function is_same

   !> Write record files: a valid one in each format, and damaged ones.
   subroutine write_records()
      call write_file('good', '# t, a'//nl//'0.0 0.01'//nl//'0.01, 0.2'//nl//'0.02 -0.1'//nl)
      call write_file('at2', 'a site'//nl//'NPTS=  4, DT= .0100 SEC'//nl//'0.1 0.2 -.1 0'//nl)
      call write_file('word', '0.0 0.01'//nl//'0.01 zero'//nl)
      call write_file('times', '0.0 0.01'//nl//'0.0125 0'//nl//'0.0124 0'//nl)
      call write_file('few', 'a site'//nl//'NPTS=  4, DT= .0100 SEC'//nl//'0.1 0.2'//nl)
   end subroutine write_records

   subroutine write_file(name, text)
      character(*), intent(in) :: name
      character(*), intent(in) :: text
      integer :: stat
      integer :: unit

      open (newunit=unit, file=folder//'/'//name//'.txt', access='stream', form='unformatted', &
         status='new', action='write', iostat=stat)
      if (stat == 0) write (unit, iostat=stat) text
      if (stat == 0) close (unit, iostat=stat)
      call checks%that(stat == 0, 'a record to be read: '//name)
   end subroutine write_file

   !> Number as text, written without the library.
   function decimal(number, factor) result(text)
      integer, intent(in) :: number
      real(wp), intent(in) :: factor
      character(24) :: text

      write (text, '(f0.6)') number*factor
   end function decimal

   !> Read a case.
   subroutine read_one(number, answer)
      integer, intent(in) :: number
      type(answer_t), intent(out) :: answer
      type(case_t) :: case
      type(error_t), allocatable :: error
      character(:), allocatable :: part

      if (mod(number, 2) == 0) then
         call wrong_part(number, part)
      else
         part = '&motion kind = ''record'', file = '//trim(merge('''good.txt'', unit = ''g''', &
            '''at2.txt''             ', mod(number, 4) == 1))//' / &initial theta_over_alpha = ' &
            //trim(decimal(number, 1.0e-5_wp))//' /'
      end if
      call read_case_text('! '//repeat('-', mod(number, 90))//nl//'&wall h = 2, b = ' &
         //trim(decimal(number, 1.0e-4_wp))//' /'//nl//'&frame T_s = ' &
         //trim(decimal(number, 3.1e-3_wp))//', gamma = 5, xi_s = 0.05 /'//nl &
         //'&impact rule = ''coupled'' / &model formulation = '//trim(merge('''exact''    ', &
         '''symmetric''', mod(number, 3) == 0))//' / &solver t_end = 1'//repeat('0', &
         mod(number, 4))//' /'//nl//part, folder//'/', case, error)
      if (allocated(error)) then
         answer%text = error%name//' '//error%message
      else
         answer%text = case%text//case%motion%file//case%model%formulation//case%solver%method
         answer%values = [case%wall%b, case%frame%T_s, case%initial%theta_over_alpha, &
            case%solver%t_end, case%solver%rtol, case%record%peak, case%record%t_peak, &
            real(case%record%n, wp)]
      end if
   end subroutine read_one

   !> Invalid part of a case, with a different error and length for each number.
   subroutine wrong_part(number, part)
      integer, intent(in) :: number
      character(:), allocatable, intent(out) :: part
      character(24) :: x
      character(20) :: word

      x = decimal(number, 3.3e-3_wp)
      word = repeat('abcdefghij', 2)
      word = word(:1 + mod(number/26, 20))
      select case (mod(number/2, 13))
      case (0)
         part = '&motio'//trim(word)//' kind = ''sine'' /'
      case (1)
         part = '&output rtol_'//trim(word)//' = '//trim(x)//' /'
      case (2)
         part = '&motion kind = '''//trim(word)//''' /'
      case (3)
         part = '&cable eta_0 = -'//trim(x)//' /'
      case (4)
         part = '&cable eta_0 = '//trim(word)//' /'
      case (5)
         part = '&output dt = '''//trim(word)
      case (6)
         part = '&motion kind = ''record'', file = '''//trim(word)//'.txt'', unit = ''g'' /'
      case (7)
         part = '&motion kind = ''record'', file = ''word.txt'', unit = ''g'' /'//repeat(nl, 3)
         part = repeat(nl, mod(number, 40))//part
      case (8)
         part = '&motion kind = ''record'', file = ''times.txt'', unit = ''g'' /'
         part = repeat(nl, mod(number, 40))//part
      case (9)
         part = repeat(nl, mod(number, 40))//'&motion kind = ''record'', file = ''few.txt'' /'
      case (10)
         part = '&initial theta_over_alpha = 99999'//trim(x)//' /'
      case (11)
         part = '&link L = 0.00'//trim(adjustl(x(index(x, '.') + 1:)))//'1 /'
      case default
         part = '&cable eta_0 = 1'//trim(x)//', eta_alpha = 1, eta_y = 3 /'
      end select
   end subroutine wrong_part

   !> Run a case and write its files.
   subroutine run_one(number, answer)
      integer, intent(in) :: number
      type(answer_t), intent(out) :: answer
      type(case_t) :: case
      type(error_t), allocatable :: error
      type(result_t) :: result
      character(:), allocatable :: bytes
      character(24) :: name
      integer :: i

      name = 'run'//integer_to_text(number)
      call read_case_text(wall//scene_of(number), '', case, error)
      if (.not. allocated(error)) call simulate(case, result, error)
      if (allocated(error)) then
         answer%text = error%name//' '//error%message
         return
      end if
      answer%text = ''
      if (.not. allocated(result%warnings)) allocate (result%warnings(0))
      do i = 1, size(result%warnings)
         answer%text = answer%text//trim(result%warnings(i))//nl
      end do
      ! the wall-clock time differs from run to run
      result%seconds = 0
      call write_result(case, result, folder, trim(name), error)
      if (.not. allocated(error)) then
         call read_file(folder//'/'//trim(name)//'.summary.csv', bytes, error)
      end if
      if (allocated(error)) then
         answer%text = error%message
      else
         answer%text = answer%text//bytes
         answer%values = [result%theta_max, result%t_end]
      end if
   end subroutine run_one

   !> Scene with its own warning or error, depending on the number.
   function scene_of(number) result(text)
      integer, intent(in) :: number
      character(400) :: text
      character(24) :: x

      x = decimal(number, 1.0e-4_wp)
      select case (mod(number, 10))
      case (1)
         text = '&motion kind = ''sine'', a_max_g = 0.3, T_p = 1 / &solver t_end = 1 / &fuse ' &
            //'eta_y = 1'//trim(x)//', stroke_y = 0.01'
      case (3, 7)
         text = '&impact rule = ''constant'', e = 0.99'//trim(x(2:))//' / &initial ' &
            //'theta_over_alpha = 0.1 / &solver t_end = 0.1'
      case (5)
         text = '&motion kind = ''sine'', a_max_g = 0.4, T_p = 1 / &vertical ratio = 9.' &
            //trim(x(2:))//' / &solver t_end = 2, rtol = 1e-6'
      case (9)
         text = '&motion kind = ''sine'', a_max_g = 0.5, T_p = 1 / &solver t_end = 1, ' &
            //'rtol = 1e-6 / &output reactions = true, friction_limit = 0.0'//trim(x(2:))
      case default
         text = '&motion kind = ''sine'', a_max_g = 1'//trim(x)//', T_p = 1 / &solver ' &
            //'t_end = 10, max_steps = '//integer_to_text(20 + mod(number, 10))
      end select
      text = trim(text)//' /'
   end function scene_of

   !> Advance a wall as a host and compute its force.
   subroutine step_one(number, answer)
      integer, intent(in) :: number
      type(answer_t), intent(out) :: answer
      type(case_t) :: case
      type(error_t), allocatable :: error
      type(stepping_t) :: stepping
      type(wall_element_t) :: element
      type(element_response_t) :: response
      real(wp) :: t
      real(wp) :: peak
      real(wp) :: u

      t = 1 + number*1.7e-4_wp
      u = merge(0.1_wp, 10*t, mod(number, 2) == 1)
      peak = merge(-t, t, mod(number, 8) == 4)
      call read_case_text(wall//'&solver t_end = 1, rtol = 1e-5 / ' &
         //'&initial theta_over_alpha = 0.2 /', '', case, error)
      if (.not. allocated(error)) call create_element(element, case, error)
      if (.not. allocated(error) .and. mod(number, 8) /= 2) then
         call create_stepping(stepping, case, error, peak=peak)
         if (.not. allocated(error)) call advance_stepping(stepping, t, error)
         if (.not. allocated(error) .and. mod(number, 8) == 6) then
            call advance_stepping(stepping, t/3, error)
         else if (.not. allocated(error) .and. mod(number, 8) == 0) then
            call advance_stepping(stepping, [t/7, t], [0.0_wp, 0.0_wp], error)
         end if
         call destroy_stepping(stepping)
      end if
      if (.not. allocated(error)) call respond(element, 1, u, t, 0.0_wp, 0.0_wp, response, error)
      answer%text = ''
      if (allocated(error)) then
         answer%text = error%name//' '//error%message
      else
         answer%values = [response%force]
      end if
   end subroutine step_one

end program test_threads
