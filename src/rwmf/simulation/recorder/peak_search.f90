!> Search for the largest values of quantities over a run, piece by piece.
!>
!> The quantities are smooth between two events or knots. Both ends of a piece of motion count with
!> their one-sided values, so the values on both sides of an impact count. A short step needs no
!> search if a vibration cannot rise from its ends above the largest value so far. Any other step
!> is sampled at five places, in parts of at most a quarter of the shortest period. Candidates for
!> a new maximum are refined to round-off. In short steps, polynomials of the states locate them
!> first; the value comes from the solution of the integrator.
module rwmf_simulation_recorder_peak_search
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_roots, only: climb, close_bracket => close_in, maximum_between, maximum_t, &
      secant_between, secant_t, vertex_of_parabola
   use rwmf_model_equation, only: ground, has_further_effects
   use rwmf_model_system_assembly, only: equation_t, interval_of, rates_at
   use rwmf_motion_ground_motion, only: turning_point
   use rwmf_problem_case, only: output_t, seeks
   use rwmf_problem_quantity_values, only: put, values_t
   use rwmf_simulation_events_step_view, only: count_parts, end_of_part, rates_in, &
      sample_state, step_view_t, turning_frequency
   use rwmf_simulation_recorder_step_states, only: fit_states, may_interpolate, state_inside, &
      step_states_t
   implicit none
   private

   public :: peak_search_t, begin_search, has_search, search_piece, search_rest, search_state
   public :: find_at, peak_family_t, keep_sought, put_peaks

   integer, parameter :: n_nodes = 5
   real(wp), parameter :: node(n_nodes) = [0.0_wp, 0.5_wp - sqrt(0.125_wp), 0.5_wp, &
      0.5_wp + sqrt(0.125_wp), 1.0_wp]
   !! Chebyshev-Lobatto nodes over a part of a piece [-]

   !> Searches of one quantity, at one place or on several floors or storeys, and their outputs.
   type :: peak_family_t
      integer :: id
      !! number of the quantity
      integer :: first
      !! number of the first search
      integer :: n = 1
      !! number of searches
      integer :: step = 1
      !! distance between two of them
      real(wp) :: unit = 1
      !! unit of the output in that of the search, negative for a smallest value
      integer :: largest = 0
      !! number of the quantity that is the largest of all; 0: none
      integer :: time = 0
      !! number of the quantity that is its time; 0: none
      integer :: height = 0
      !! number of the quantity that is its height along the wall; 0: none
      real(wp) :: limit = huge(1.0_wp)
      !! largest value of the output in the unit of the search
      integer :: below = 0
      !! number of the floors or storeys below the first
      logical :: is_put = .true.
      !! the scene has the outputs, and they follow from the search alone
   end type peak_family_t

   !> Running maxima of quantities, each in its unit.
   type, abstract :: peak_search_t
      real(wp), allocatable :: largest(:)
      !! (quantities) [unit of each]
      real(wp), allocatable :: t_largest(:)
      !! (quantities) [s]
      real(wp), allocatable :: z_largest(:)
      !! (quantities) height of the largest value along the wall, where it is noted [m]
      type(peak_family_t), allocatable :: families(:)
      !! outputs of the searches
      real(wp), allocatable :: smallest(:)
      !! (quantities) lower end of the range so far [unit of each]
      integer, allocatable :: leader(:)
      !! (quantities) number of the quantity whose search serves this one; 0 if not requested. A
      !! quantity in a fixed proportion to another one has that one's number
      integer, allocatable :: pool(:)
      !! (quantities) common number of those whose largest maximum alone is requested, such as the
      !! drifts of all storeys; its own number otherwise
      real(wp), allocatable :: level(:)
      !! (quantities) largest value of the pool, which a new maximum has to exceed [unit of each]
      real(wp) :: frequency = 0
      !! frequency of the fastest vibration before yielding [rad/s]
      real(wp) :: t_end = -1
      !! end of the last piece [s]
      real(wp), allocatable :: y_end(:)
      !! (states) states at this time
      real(wp), allocatable :: rates(:, :)
      !! (states, 2) rates of the states at both ends of the last piece
      real(wp), allocatable :: at_ends(:, :)
      !! (quantities, 2) values at both ends of the last piece [unit of each]
   contains
      procedure(find_i), deferred :: find
      procedure :: note_place
   end type peak_search_t

   abstract interface
      !> Compute the quantities at a state.
      subroutine find_i(self, equation, t, y, y_dot, found)
         import :: equation_t, peak_search_t, wp
         implicit none
         class(peak_search_t), intent(inout) :: self
         type(equation_t), intent(in) :: equation
         real(wp), intent(in) :: t
         !! [s]
         real(wp), intent(in) :: y(:)
         !! (states)
         real(wp), intent(in) :: y_dot(:)
         !! (states) their rates
         real(wp), intent(out) :: found(:)
         !! (quantities)
      end subroutine find_i
   end interface

contains

   !> Initialise a search with the state at t = 0.
   subroutine begin_search(self, equation, y, least)
      class(peak_search_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: least(:)
      !! (quantities) lower bound of all values [unit of each]
      integer :: q

      self%frequency = frequency_with_springs(equation, y)
      self%largest = least
      self%level = least
      associate (n => size(least))
         allocate (self%t_largest(n), self%z_largest(n), source=0.0_wp)
         allocate (self%smallest(n), source=huge(1.0_wp))
         allocate (self%leader(n), source=[(q, q=1, n)])
         self%pool = self%leader
         allocate (self%y_end(equation%n), self%rates(equation%n, 2))
         allocate (self%at_ends(n, 2))
      end associate
   end subroutine begin_search

   !> Drop the searches that serve no requested output.
   !>
   !> If only the largest value of a family is requested, its searches form a pool.
   pure subroutine keep_sought(self, output)
      class(peak_search_t), intent(inout) :: self
      type(output_t), intent(in) :: output
      logical, dimension(size(self%leader)) :: is_sought, is_single
      !! (quantities) an output is requested; it is not the largest of a family
      integer :: i, q

      is_sought = .false.
      is_single = .false.
      do i = 1, size(self%families)
         associate (family => self%families(i))
            do q = family%first, family%first + (family%n - 1)*family%step, family%step
               is_single(q) = is_single(q) .or. seeks(output, [family%id])
               is_sought(q) = is_sought(q) .or. seeks(output, [family%id, family%largest, &
                  family%time, family%height])
            end do
         end associate
      end do
      where ([(.not. any(is_sought .and. (self%leader == q)), q=1, size(is_sought))] &
         .and. .not. is_sought) self%leader = 0
      do i = 1, size(self%families)
         associate (family => self%families(i), first => self%families(i)%first)
            if (family%largest == 0) cycle
            associate (last => first + family%n - 1)
               if (any(is_single .and. self%leader >= first .and. self%leader <= last)) cycle
               self%pool(first:last) = first
            end associate
         end associate
      end do
   end subroutine keep_sought

   !> Put the outputs of the searches.
   pure subroutine put_peaks(values, self)
      type(values_t), intent(inout) :: values
      class(peak_search_t), intent(in) :: self
      integer :: i, q

      do i = 1, size(self%families)
         associate (family => self%families(i))
            if (family%n == 0 .or. .not. family%is_put) cycle
            associate (found => self%largest(family%first:family%first + (family%n - 1) &
                       *family%step:family%step))
               call put(values, family%id, min(found, family%limit)/family%unit, family%below)
               q = family%first + (maxloc(found, dim=1) - 1)*family%step
            end associate
            if (family%largest > 0) call put(values, family%largest, self%largest(q)/family%unit)
            if (family%time > 0) call put(values, family%time, self%t_largest(q))
            if (family%height > 0) call put(values, family%height, self%z_largest(q))
         end associate
      end do
   end subroutine put_peaks

   !> Note the place along the wall of a new largest value. By default there is nothing to note.
   subroutine note_place(self, q)
      class(peak_search_t), intent(inout) :: self
      integer, intent(in) :: q
      !! number of the quantity

      associate (unused => self, also => q)
      end associate
   end subroutine note_place

   !> Return whether a quantity has its own search: it is requested and follows no other one.
   pure logical function has_search(self, q)
      class(peak_search_t), intent(in) :: self
      integer, intent(in) :: q
      !! number of the quantity

      has_search = self%leader(q) == q
   end function has_search

   !> Update the maxima with one state. A wall at rest has zero rates.
   subroutine search_state(self, equation, t, y, y_dot, leader)
      class(peak_search_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      integer, intent(in), optional :: leader
      !! as in `keep_largest`
      real(wp) :: found(size(self%largest))

      call self%find(equation, t, y, y_dot, found)
      call keep_largest(self, t, found, leader)
   end subroutine search_state

   !> Update the maxima with quantities at one instant.
   !>
   !> The points of a search update only the quantities that it serves. The bits of a maximum then
   !> do not depend on the other quantities of the request.
   subroutine keep_largest(self, t, found, leader)
      class(peak_search_t), intent(inout) :: self
      real(wp), intent(in) :: t
      real(wp), intent(in) :: found(:)
      !! (quantities)
      integer, intent(in), optional :: leader
      !! number of the quantity that is searched; absent: update all quantities
      integer :: q

      do q = 1, size(found)
         if (present(leader)) then
            if (self%leader(q) /= leader) cycle
         end if
         self%smallest(q) = min(self%smallest(q), found(q))
         if (.not. found(q) > self%largest(q)) cycle
         self%largest(q) = found(q)
         self%t_largest(q) = t
         where (self%pool == self%pool(q)) self%level = max(self%level, found(q))
         call self%note_place(q)
      end do
   end subroutine keep_largest

   !> Update the maxima over smooth motion inside the last step of the integrator.
   subroutine search_piece(self, piece, states, error)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      type(step_states_t), allocatable, intent(inout) :: states
      !! polynomials of the piece, if another search has needed them
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp) :: found(size(self%largest), n_nodes)
      real(wp), parameter :: most_parts = 1000
      real(wp) :: t(2), angle
      integer :: i, n

      if (all(self%leader == 0)) return
      call sample_ends(self, piece)
      n = 1
      angle = (piece%t_b - piece%t_a)*max(self%frequency, turning_frequency(piece))
      if (may_interpolate(piece, self%frequency)) then
         if (is_plain(self, angle, max(self%at_ends(:, 1), self%at_ends(:, 2)))) return
         if (.not. (allocated(states) .or. piece%integrator%has_polynomial)) then
            allocate (states)
            call fit_states(piece, self%rates, states, error)
            if (allocated(error)) return
         end if
      else
         n = max(count_parts(piece), ceiling(min(2*angle/pi, most_parts)))
      end if
      found(:, n_nodes) = self%at_ends(:, 1)
      t(2) = piece%t_a
      do i = 1, n
         found(:, 1) = found(:, n_nodes)
         t = [t(2), end_of_part(piece, i, n)]
         call search_part(self, piece, states, t, found, error)
         if (allocated(error)) return
      end do
   end subroutine search_piece

   !> Update the maxima with both ends of a piece.
   !>
   !> The beginning is the end of the previous piece, unless states or rates have jumped.
   subroutine sample_ends(self, piece)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      real(wp), parameter :: slack = 1.0e-12_wp
      logical :: goes_on

      associate (found => self%at_ends, rates => self%rates)
         goes_on = abs(self%t_end - piece%t_a) <= 0
         if (goes_on) goes_on = all(abs(self%y_end - piece%y_a) <= 0)
         call rates_in(piece, piece%t_a, piece%y_a, rates(:, 1))
         if (goes_on) goes_on = all(abs(rates(:, 1) - rates(:, 2)) <= slack*abs(rates(:, 1)))
         if (goes_on) then
            found(:, 1) = found(:, 2)
         else
            call self%find(piece%equation, piece%t_a, piece%y_a, rates(:, 1), &
               found(:, 1))
            call keep_largest(self, piece%t_a, found(:, 1))
         end if
         call rates_in(piece, piece%t_b, piece%y_b, rates(:, 2))
         call self%find(piece%equation, piece%t_b, piece%y_b, rates(:, 2), found(:, 2))
         call keep_largest(self, piece%t_b, found(:, 2))
      end associate
      self%t_end = piece%t_b
      self%y_end(:) = piece%y_b
   end subroutine sample_ends

   !> Return true if samples of a short step exclude a larger value between them.
   pure logical function is_plain(self, angle, highest)
      class(peak_search_t), intent(in) :: self
      real(wp), intent(in) :: angle
      !! phase of the fastest vibration between two samples [rad]
      real(wp), intent(in) :: highest(:)
      !! (quantities) the largest of the samples
      real(wp), parameter :: rise = 0.5_wp
      !! possible rise over the range so far and the angle squared. A second harmonic rises by this
      !! much above both ends, a vibration by a quarter of it [-]
      real(wp), parameter :: least_rise = 0.02_wp, stiff_rise = 100
      !! values for a stiff cable that vibrates faster; its frequency is not computed
      real(wp), parameter :: least_range = 0.25_wp
      !! least range so far over the magnitude of the level: after a start or an event, a vibration
      !! has not shown its range yet [-]
      real(wp) :: margin, range
      integer :: q

      margin = max(min(least_rise, stiff_rise*angle**2), rise*angle**2)
      is_plain = .false.
      do q = 1, size(self%largest)
         if (.not. has_search(self, q)) cycle
         range = max(self%level(q) - self%smallest(q), least_range*abs(self%level(q)))
         if (.not. highest(q) + margin*range <= self%level(q)) return
      end do
      is_plain = .true.
   end function is_plain

   !> Update the maxima over a part of at most a quarter of the shortest period.
   subroutine search_part(self, piece, states, t, found, error)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      type(step_states_t), intent(in), allocatable :: states
      real(wp), intent(in) :: t(2)
      !! ends of the part [s]
      real(wp), intent(inout) :: found(:, :)
      !! (quantities, nodes) values; those at the first node are known
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: times(n_nodes)
      integer :: i, q

      times = t(1) + (t(2) - t(1))*node
      times(n_nodes) = t(2)
      do i = 2, n_nodes
         if (times(i) >= piece%t_b) then
            found(:, i) = self%at_ends(:, 2)
         else
            call sample(self, piece, states, times(i), found(:, i), error)
         end if
         if (allocated(error)) return
      end do
      do q = 1, size(found, 1)
         if (.not. has_search(self, q)) cycle
         if (.not. has_peak_inside(found(q, :), self%level(q))) cycle
         call close_in(self, piece, states, q, times, found(q, :), error)
         if (allocated(error)) return
      end do
   end subroutine search_part

   !> Refine the maximum of a quantity between the nodes.
   subroutine close_in(self, piece, states, q, times, found, error)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      type(step_states_t), intent(in), allocatable :: states
      integer, intent(in) :: q
      !! number of the quantity
      real(wp), intent(in) :: times(n_nodes)
      !! [s]
      real(wp), intent(in) :: found(n_nodes)
      !! approximate values at these times
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: miss = 0.1_wp
      !! possible distance of the first point from the maximum, over the range in the part [-]
      type(maximum_t) :: search
      type(step_states_t), allocatable :: no_states
      real(wp) :: at_point(size(self%largest))
      real(wp) :: vertex
      integer :: k

      k = min(max(maxloc(found, dim=1), 2), n_nodes - 1)
      vertex = vertex_of_parabola(times(k - 1:k + 1), found(k - 1:k + 1))
      if (.not. (vertex > times(k - 1) .and. vertex < times(k + 1))) vertex = times(k)
      search = maximum_between(times(k - 1), times(k + 1), vertex, is_near=.true.)
      do while (search%is_open)
         call sample(self, piece, states, search%next, at_point, error, q)
         if (allocated(error)) return
         if (at_point(q) + miss*(maxval(found) - minval(found)) < self%level(q)) return
         call climb(search, at_point(q))
      end do
      if (allocated(states)) call sample(self, piece, no_states, search%x(1), at_point, error, q)
   end subroutine close_in

   !> Compute the quantities inside a piece, or while the wall rests, from the solution of the
   !> integrator.
   subroutine find_at(self, piece, t, found, error)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      !! without an integrator at rest
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(out) :: found(:)
      !! (quantities) [unit of each]
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      real(wp), dimension(size(piece%y_a)) :: y, y_dot

      if (associated(piece%integrator)) then
         call sample_state(piece, t, y, error)
         if (allocated(error)) return
         call rates_at(piece%equation, t, y, y_dot)
      else
         y = piece%y_a
         y_dot = 0
      end if
      call self%find(piece%equation, t, y, y_dot, found)
   end subroutine find_at

   !> Compute the quantities inside a piece for a search.
   !>
   !> They update the maxima only if the state comes from the integrator.
   subroutine sample(self, piece, states, t, found, error, leader)
      class(peak_search_t), intent(inout) :: self
      type(step_view_t), intent(in) :: piece
      type(step_states_t), intent(in), allocatable :: states
      !! polynomials for an approximate state; not allocated for the state of the integrator
      real(wp), intent(in) :: t
      real(wp), intent(out) :: found(:)
      type(error_t), allocatable, intent(out) :: error
      integer, intent(in), optional :: leader
      !! as in `keep_largest`
      real(wp), dimension(size(piece%y_a)) :: y, y_dot

      if (allocated(states)) then
         call state_inside(states, t, y)
         call rates_at(piece%equation, t, y, y_dot)
         call self%find(piece%equation, t, y, y_dot, found)
      else
         call find_at(self, piece, t, found, error)
         if (.not. allocated(error)) call keep_largest(self, t, found, leader)
      end if
   end subroutine sample

   !> Update the maxima over the current interval of the motion, with the wall at rest.
   !>
   !> Forces and accelerations are linear in the ground acceleration, so they are largest at its
   !> turning points or at the ends. Velocities are largest at its zeros. A quotient of forces may
   !> be largest elsewhere if a vertical motion accompanies a pulse.
   subroutine search_rest(self, equation, y, t_a, t_b)
      class(peak_search_t), intent(inout) :: self
      type(equation_t), intent(in), target :: equation
      real(wp), intent(in), contiguous, target :: y(:)
      !! (states)
      real(wp), intent(in) :: t_a
      !! [s]
      real(wp), intent(in) :: t_b
      !! [s]
      type(error_t), allocatable :: error
      !! never set: no integrator is involved
      type(step_states_t), allocatable :: no_states
      type(secant_t) :: search
      type(step_view_t) :: rest
      real(wp) :: t, next, still(size(y)), found(size(self%largest), n_nodes)

      if (all(self%leader == 0)) return
      rest%equation => equation
      rest%y_a => y
      rest%t_b = huge(t)
      still = 0
      t = t_a
      call search_state(self, equation, t, y, still)
      do while (t < t_b)
         next = min(turning_point(equation%motion, interval_of(equation), t), t_b)
         if (has_further_effects(equation) .and. .not. equation%state%line%is_straight) then
            call self%find(equation, t, y, still, found(:, 1))
            call search_part(self, rest, no_states, [t, next], found, error)
         end if
         if (ground(equation, t)*ground(equation, next) < 0) then
            search = secant_between([t, next], [ground(equation, t), ground(equation, next)])
            do while (search%is_open)
               t = search%next
               call close_bracket(search, ground(equation, t))
            end do
            call search_state(self, equation, t, y, still)
         end if
         t = next
         call search_state(self, equation, t, y, still)
      end do
   end subroutine search_rest

   !> Highest natural frequency, including that of the wall on its springs and cable [rad/s].
   real(wp) function frequency_with_springs(equation, y) result(frequency)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), parameter :: small = 1.0e-6_wp
      !! [rad]
      real(wp), dimension(size(y)) :: beside, rates, rates_beside

      ! highest natural frequency of a scene [rad/s]
      frequency = max(equation%p%omega_s, equation%floors%max_frequency, sqrt(equation%p%g &
         /equation%p%R))
      if (.not. equation%has_wall) return
      beside = y
      beside(1) = y(1) + sign(small, y(1))
      call rates_at(equation, 0.0_wp, y, rates)
      call rates_at(equation, 0.0_wp, beside, rates_beside)
      frequency = max(frequency, sqrt(max(0.0_wp, (rates(2) - rates_beside(2)) &
         /(beside(1) - y(1)))))
   end function frequency_with_springs

   !> Return whether a peak that may reach a level lies between the ends, from values at the nodes.
   !>
   !> The peak follows from the parabola through the largest value and its neighbours. If an end is
   !> largest, the slope of the polynomial through all nodes shows a peak beside it.
   pure logical function has_peak_inside(found, level) result(has_peak)
      real(wp), intent(in) :: found(n_nodes)
      !! the quantity at the nodes, in any unit
      real(wp), intent(in) :: level
      !! value above which a peak counts, in the same unit
      real(wp), parameter :: margin = 0.1_wp
      !! tolerance over the range of the samples, and over the width of the parabola [-]
      real(wp) :: vertex, peak, width, slope, bend
      integer :: best, k

      best = maxloc(found, dim=1)
      k = min(max(best, 2), n_nodes - 1)
      width = node(k + 1) - node(k - 1)
      slope = (found(k) - found(k - 1))/(node(k) - node(k - 1))
      bend = ((found(k + 1) - found(k))/(node(k + 1) - node(k)) - slope)/width
      vertex = vertex_of_parabola(node(k - 1:k + 1), found(k - 1:k + 1))
      peak = found(best)
      has_peak = bend < 0 .and. vertex > node(k - 1) - margin*width .and. vertex < node(k + 1) &
         + margin*width
      if (has_peak) then
         peak = max(peak, found(k - 1) + (vertex - node(k - 1))*(slope + bend*(vertex - node(k))))
      else if (best > 1 .and. best < n_nodes) then
         has_peak = .true.
      else
         call derivatives(node, found, node(best), slope, bend)
         has_peak = merge(slope, -slope, best == 1) > 0
      end if
      has_peak = has_peak .and. peak + margin*(maxval(found) - minval(found)) >= level
   end function has_peak_inside

   !> Compute first and second derivative of the polynomial through the nodes, by Newton's form.
   pure subroutine derivatives(t, f, at, slope, bend)
      real(wp), intent(in) :: t(n_nodes), f(n_nodes)
      !! times [s] and values of f in any unit
      real(wp), intent(in) :: at
      !! [s]
      real(wp), intent(out) :: slope, bend
      real(wp) :: c(n_nodes), value
      integer :: i, j

      c = f
      do j = 2, n_nodes
         do i = n_nodes, j, -1
            c(i) = (c(i) - c(i - 1))/(t(i) - t(i - j + 1))
         end do
      end do
      value = c(n_nodes)
      slope = 0
      bend = 0
      do i = n_nodes - 1, 1, -1
         bend = bend*(at - t(i)) + 2*slope
         slope = slope*(at - t(i)) + value
         value = value*(at - t(i)) + c(i)
      end do
   end subroutine derivatives

end module rwmf_simulation_recorder_peak_search
