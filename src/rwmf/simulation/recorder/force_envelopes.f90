!> Envelopes of the design forces of wall and links, velocities of floors, forces and travel of
!> vertical elements.
!>
!> Shear and moment are computed below and above every floor, at the base and at mid-height. The
!> module `rwmf_simulation_recorder_peak_search` finds the peaks.
module rwmf_simulation_recorder_force_envelopes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: frame_motion, kinematics_at
   use rwmf_model_floor_motion, only: floor_motion, follows_roof
   use rwmf_problem_quantity_values, only: values_t, put
   use rwmf_model_no_tension_strip, only: contact_length, settlement_stress, strip_t
   use rwmf_model_system_assembly, only: equation_t, interval_of
   use rwmf_model_system_bent_sections, only: find_bent_sections
   use rwmf_model_system_demands, only: building_of, building_t, links_of
   use rwmf_model_system_reactions, only: has_section_forces, normal_range, reactions_at, &
      reactions_t
   use rwmf_model_system_wall_sections, only: find_forces_beside, links_t
   use rwmf_motion_ground_motion, only: interval_at, velocities_at_knots, velocity
   use rwmf_problem_case, only: case_t, has_numbers, numbers_of, seeks
   use rwmf_problem_quantity_table, only: id
   use rwmf_simulation_events_first_change, only: stop_at_change
   use rwmf_simulation_events_step_view, only: step_view_t
   use rwmf_simulation_events_rotation_events, only: keeps_direction, rotation_t
   use rwmf_simulation_events_watched_spans, only: moment_t, span_between, span_of, span_t, watch_t
   use rwmf_simulation_recorder_element_demands, only: element_extremes_t, &
      element_ids, extremes_of, force_of, of_force, of_least_force, put_elements, travel_of, &
      watched_elements
   use rwmf_simulation_recorder_peak_search, only: begin_search, keep_sought, &
      peak_family_t, peak_search_t, put_peaks
   implicit none
   private

   public :: envelope_recorder_t, create_envelopes, follow_elements
   public :: put_envelopes, put_envelope_extremes
   public :: place_sections, lay_strip, find_sections, put_strip, of_series

   integer, parameter :: of_normal = 1
   !! places of the quantities after the velocities of the floors; normal force of the pivot
   integer, parameter :: of_base = 2
   !! shear at the base; the next is the moment there
   integer, parameter :: of_middle = 4
   !! shear at mid-height; the next is the moment there
   integer, parameter :: of_sections = 5
   !! place before the four of each floor: shear below and above it, moment below and above it
   integer, parameter :: per_floor = 4
   integer, parameter :: of_strip = 2
   !! last quantities with a strip under the base: contact length, negative, and the stress of the
   !! toe's settlement

   !> Running maxima over m_w: shears [m/s2], moments [m2/s2], link forces and normal force [m/s2].
   !>
   !> Velocities of floors [m/s] are not divided by a mass.
   type, extends(peak_search_t) :: envelope_recorder_t
      type(building_t) :: building
      real(wp), allocatable :: ground_velocity(:)
      !! result of `velocities_at_knots` [m/s]
      real(wp) :: velocity_before = 0
      !! velocity of the ground motion at t = 0, where the run begins at rest [m/s]
      real(wp), allocatable :: z(:)
      !! (sections) heights: base, floors, and mid-height unless it is a floor [m]
      integer :: middle = 0
      !! number of the section at mid-height
      integer, allocatable :: of_floor(:)
      !! (floors) number of the section of each
      type(links_t) :: links
      !! link forces at the last instant
      integer, allocatable :: nodes(:)
      !! (sections) node of each section of a bending wall
      real(wp), allocatable :: below(:, :), above(:, :)
      !! (2, sections) shear and moment at the last instant [m/s2], [m2/s2]
      integer, allocatable :: watched(:)
      !! numbers of the vertical elements with own outputs
      real(wp), allocatable :: travel(:)
      !! (these elements) sum of strokes [m]
      logical :: sums_strokes = .true.
      !! these sums are requested
      integer :: n_links = 0
      !! number of link forces
      type(strip_t), allocatable :: strip
      !! strip under the base; absent without `&base_section`
      real(wp) :: m_w = 0
      !! mass of the wall on the strip [kg]
      real(wp), allocatable :: modulus
      !! modulus of the strip [Pa]; absent if it is unknown
   contains
      procedure :: find => find_envelopes
   end type envelope_recorder_t

contains

   !> Initialise the envelopes if the case requests them.
   subroutine create_envelopes(recorder, case, equation, y)
      type(envelope_recorder_t), allocatable, intent(out) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states) at the beginning
      real(wp), allocatable :: least(:)
      integer :: i

      if (.not. allocated(case%output)) return
      if (.not. case%output%envelopes) return
      allocate (recorder)
      call building_of(case, equation, recorder%building)
      recorder%ground_velocity = velocities_at_knots(equation%motion)
      recorder%velocity_before = velocity(equation%motion, recorder%ground_velocity, &
         interval_at(equation%motion, 0.0_wp), 0.0_wp)
      recorder%watched = watched_elements(equation)
      recorder%travel = spread(0.0_wp, 1, size(recorder%watched))
      associate (n => recorder%building%floors)
         least = spread(-1.0_wp, 1, n)
         if (equation%has_wall) then
            call place_sections(recorder, equation)
            recorder%n_links = min(1, n)
            if (equation%floors%are_linked) recorder%n_links = n
            least = [least, -huge(1.0_wp), spread(-1.0_wp, 1, of_sections - 1 + per_floor*n &
               + recorder%n_links)]
            call lay_strip(recorder, case, equation)
            if (allocated(recorder%strip)) least = [least, -huge(1.0_wp), -1.0_wp]
            least = [least, spread(-huge(1.0_wp), 1, 2*size(recorder%watched))]
         end if
         call begin_search(recorder, equation, y, least)
         ! Sections without a link have equal forces on both sides, and the wall ends at the roof:
         ! forces above them need no separate search.
         do i = 1, merge(n, 0, equation%has_wall)
            if (i < n .and. equation%floors%are_linked) cycle
            associate (first => n + of_sections + per_floor*(i - 1))
               recorder%leader([first + 2, first + 4]) = first + [1, 3]
            end associate
         end do
      end associate
      recorder%families = families_of(recorder, equation)
      call keep_sought(recorder, case%output)
      recorder%sums_strokes = seeks(case%output, [id%fuse_stroke_sum_m, id%fuse_i_stroke_sum_m, &
         id%restraint_i_stroke_sum_m, id%coupling_stroke_sum_m])
   end subroutine create_envelopes

   !> Outputs of the searches.
   pure function families_of(recorder, equation) result(families)
      type(envelope_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      type(peak_family_t), allocatable :: families(:)
      integer :: i, first, last

      associate (n => recorder%building%floors, links => recorder%n_links, g => equation%p%g)
         families = [peak_family_t(id%floor_i_velocity_max_m_s, 1, n)]
         if (.not. equation%has_wall) return
         first = n + of_sections + 1
         last = n + of_sections + per_floor*n + links
         families = [families, peak_family_t(id%pivot_normal_max_over_m_w_g, n + of_normal), &
            peak_family_t(id%wall_shear_base_max_over_m_w_g, n + of_base), &
            peak_family_t(id%wall_moment_base_max_over_m_w_g_m, n + of_base + 1), &
            peak_family_t(id%wall_shear_mid_max_over_m_w_g, n + of_middle), &
            peak_family_t(id%wall_moment_mid_max_over_m_w_g_m, n + of_middle + 1), &
            peak_family_t(id%wall_shear_i_max_over_m_w_g, first, n, per_floor), &
            peak_family_t(id%wall_shear_i_above_max_over_m_w_g, first + 1, n, per_floor), &
            peak_family_t(id%wall_moment_i_max_over_m_w_g_m, first + 2, n, per_floor), &
            peak_family_t(id%wall_moment_i_above_max_over_m_w_g_m, first + 3, n, per_floor), &
            peak_family_t(id%link_i_force_max_over_m_w_g, last - links + 1, links, &
            below=n - links)]
         families(2:)%unit = g
         families(3:)%is_put = has_section_forces(equation)
      end associate
      if (allocated(recorder%strip)) then
         families = [families, peak_family_t(id%contact_length_min_m, last + 1, unit=-1.0_wp), &
            peak_family_t(id%toe_stress_max_Pa, last + 2, limit=recorder%strip%strength)]
         if (allocated(recorder%modulus)) families = [families, &
            peak_family_t(id%toe_strain_max, last + 2, unit=recorder%modulus)]
         last = last + of_strip
      end if
      do i = 1, size(recorder%watched)
         associate (ids => element_ids(:, equation%elements(recorder%watched(i))%group))
            families = [families, peak_family_t(ids(of_force), last + 2*i - 1, is_put=.false.)]
            ! only tendons report their smallest force
            if (ids(of_least_force) > 0) families = [families, peak_family_t( &
               ids(of_least_force), last + 2*i, is_put=.false.)]
         end associate
      end do
   end function families_of

   !> Numbers of the quantities whose values are sums of series: the normal force of the pivot, and
   !> with a frame the force of its link.
   pure function of_series(recorder) result(numbers)
      type(envelope_recorder_t), intent(in) :: recorder
      !! of a scene with a wall, whose frame has one link
      integer :: numbers(1 + recorder%n_links)

      associate (n => recorder%building%floors)
         numbers = n + of_sections + per_floor*n + recorder%n_links
         numbers(1) = n + of_normal
      end associate
   end function of_series

   !> Compute the heights of the sections, in ascending order.
   subroutine place_sections(recorder, equation)
      type(envelope_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      !! equation of a scene with a wall
      real(wp), parameter :: same = 1.0e-9_wp
      !! distance of a floor from mid-height, over the height [-]
      real(wp), allocatable :: share(:)
      integer :: i, n

      n = recorder%building%floors
      allocate (share(n))
      if (n > 0) share = recorder%building%z/recorder%building%z(n)
      recorder%of_floor = [(i + 1, i=1, n)]
      i = count(share < 0.5_wp - same) + 1
      recorder%middle = i + 1
      if (count(abs(share - 0.5_wp) <= same) == 0) then
         share = [share(:i - 1), 0.5_wp, share(i:)]
         recorder%of_floor(i:) = recorder%of_floor(i:) + 1
      end if
      recorder%z = 2*equation%p%R*equation%p%cos_alpha*[0.0_wp, share]
      allocate (recorder%below(2, size(recorder%z)), recorder%above(2, size(recorder%z)))
      if (equation%beam%n == 0) return
      associate (sections => recorder%building%sections)
         recorder%nodes = [0, sections%of_floor]
         if (size(recorder%z) > n + 1) recorder%nodes = [recorder%nodes(:i), sections%middle, &
            recorder%nodes(i + 1:)]
      end associate
   end subroutine place_sections

   !> Put the strip of `&base_section` under the base.
   pure subroutine lay_strip(recorder, case, equation)
      type(envelope_recorder_t), intent(inout) :: recorder
      type(case_t), intent(in) :: case
      type(equation_t), intent(in) :: equation
      !! equation of a scene with a wall

      if (.not. has_numbers(case, 'base_section')) return
      associate (numbers => numbers_of(case, 'base_section'))
         recorder%strip = strip_t(2*equation%p%R*equation%p%sin_alpha, numbers(2), numbers(1), &
            numbers(3))
      end associate
      recorder%m_w = case%unit_mass
      if (has_numbers(case, 'toe_strain')) recorder%modulus = sum(numbers_of(case, 'toe_strain'))
   end subroutine lay_strip

   !> Compute the quantities at a state.
   subroutine find_envelopes(self, equation, t, y, y_dot, found)
      class(envelope_recorder_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      real(wp), intent(out) :: found(:)
      !! (quantities)
      type(reactions_t) :: reactions
      integer :: i, n

      n = self%building%floors
      found(:n) = abs(floor_velocities(self, equation, t, y))
      if (.not. equation%has_wall) return
      call find_forces(self, equation, t, y, y_dot)
      reactions = reactions_at(equation, t, y, y_dot)
      associate (forces => found(n + 1:), below => self%below, above => self%above)
         reactions%normal = maxval(normal_range(equation, reactions%normal, y))
         forces(of_normal) = reactions%normal
         forces(of_base:of_base + 1) = abs(above(:, 1))
         forces(of_middle:of_middle + 1) = max(abs(below(:, self%middle)), &
            abs(above(:, self%middle)))
         do i = 1, n
            associate (first => of_sections + per_floor*(i - 1), section => self%of_floor(i))
               forces(first + 1:first + 3:2) = abs(below(:, section))
               forces(first + 2:first + 4:2) = abs(above(:, section))
            end associate
         end do
         associate (last => of_sections + per_floor*n + self%n_links)
            forces(last - self%n_links + 1:last) = norm2(self%links%force, 1)
            if (allocated(self%strip)) forces(last + 1:last + of_strip) = at_base(self, &
               reactions%normal, y(1))
         end associate
      end associate
      do i = 1, size(self%watched)
         associate (last => size(found) - 2*(size(self%watched) - i), &
            force => force_of(equation, self%watched(i), y))
            found(last - 1:last) = [abs(force), -force]
         end associate
      end do
   end subroutine find_envelopes

   !> Contact length, negative [m], and stress of the toe's settlement [Pa] of the strip.
   pure function at_base(self, normal, theta) result(found)
      type(envelope_recorder_t), intent(in) :: self
      !! with a strip
      real(wp), intent(in) :: normal
      !! normal force of the pivot over m_w [m/s2]
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: found(of_strip)

      found = [-contact_length(self%strip, self%m_w*normal, abs(theta)), &
         settlement_stress(self%strip, self%m_w*normal, abs(theta))]
   end function at_base

   !> Compute the forces of the links and at the sections, with their signs.
   subroutine find_forces(self, equation, t, y, y_dot)
      class(envelope_recorder_t), intent(inout) :: self
      type(equation_t), intent(in) :: equation
      !! equation of a scene with a wall
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates

      call links_of(self%building, equation, kinematics_at(equation, y(1)), t, y, y_dot, &
         self%links)
      call find_sections(self, equation, t, y, y_dot)
   end subroutine find_forces

   !> Compute the forces at the sections for given forces of the links, with their signs.
   subroutine find_sections(self, equation, t, y, y_dot)
      class(envelope_recorder_t), intent(inout) :: self
      !! with the forces of the links
      type(equation_t), intent(in) :: equation
      !! equation of a scene with a wall
      real(wp), intent(in) :: t
      !! time [s]
      real(wp), intent(in) :: y(:)
      !! (states) [units of the states]
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates [units of the states/s]
      real(wp), parameter :: round_off = 1.0e-10_wp
      !! of a moment over the largest one [-]

      if (equation%beam%n > 0) then
         associate (sections => self%building%sections)
            call find_bent_sections(sections, equation, t, y, y_dot, self%links)
            self%below(:, :) = sections%below_node(:, self%nodes)
            self%above(:, :) = sections%above_node(:, self%nodes)
         end associate
      else
         call find_forces_beside(equation, t, y, y_dot(2), self%links, self%z, self%below, &
            self%above)
      end if
      ! the wall ends at the roof
      if (self%building%floors > 0) self%above(:, size(self%z)) = 0
      ! a hinge without fuses or dampers leaves the round-off of the other moments
      associate (moments => abs(self%above(2, :)))
         if (equation%geometry%sine_wall <= 0 .and. moments(1) <= round_off*maxval(moments)) then
            self%below(2, 1) = 0
            self%above(2, 1) = 0
         end if
      end associate
   end subroutine find_sections

   !> Absolute velocities of the floors [m/s].
   function floor_velocities(self, equation, t, y) result(v)
      class(envelope_recorder_t), intent(in) :: self
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp) :: v(self%building%floors)
      real(wp) :: u(0:self%building%floors), roof(2)

      if (size(v) == 0) return
      if (.not. follows_roof(equation)) then
         call floor_motion(equation, equation%state%side, y, u, v)
      else
         call frame_motion(equation, equation%state%side, y, roof(1), roof(2))
         v = self%building%share*roof(2)
      end if
      v = v + velocity(equation%motion, self%ground_velocity, interval_of(equation), t) &
         - self%velocity_before
   end function floor_velocities

   !> Add the travel of the elements over a piece, with every turning point of the rotation.
   subroutine follow_elements(recorder, piece, error)
      type(envelope_recorder_t), intent(inout) :: recorder
      type(step_view_t), intent(in) :: piece
      type(error_t), allocatable, intent(out) :: error
      !! the integrator fails
      integer, parameter :: most_turns = 20
      !! further ones in a piece are round-off
      type(rotation_t) :: rotation
      type(moment_t) :: b
      type(span_t) :: span
      type(watch_t) :: watch
      logical :: turns
      integer :: i

      if (.not. recorder%sums_strokes .or. size(recorder%watched) == 0) return
      if (keeps_direction(piece)) then
         call add_travel(recorder, piece%equation, piece%y_a(1), piece%y_b(1))
         return
      end if
      rotation%step = piece
      rotation%states = [1, 2]
      span = span_of(rotation)
      b = span%b
      watch = watch_t(1, 1, side=sign(1.0_wp, span%a%f(1, 1)))
      if (abs(span%a%f(1, 1)) <= 0) watch%side = sign(1.0_wp, span%a%f(1, 2))
      do i = 1, most_turns
         call stop_at_change(rotation, watch, span, turns, error)
         if (allocated(error)) return
         call add_travel(recorder, piece%equation, span%a%f(1, 0), span%b%f(1, 0))
         if (.not. turns) return
         watch%side = -watch%side
         span = span_between(rotation, span%b, b)
      end do
      call add_travel(recorder, piece%equation, span%a%f(1, 0), b%f(1, 0))
   end subroutine follow_elements

   !> Add the travel of the elements between two rotations.
   pure subroutine add_travel(recorder, equation, theta_a, theta_b)
      type(envelope_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta_a, theta_b
      !! [rad]
      integer :: i

      do i = 1, size(recorder%watched)
         recorder%travel(i) = recorder%travel(i) + travel_of(equation, recorder%watched(i), &
            theta_a, theta_b)
      end do
   end subroutine add_travel

   !> Fill in the columns of the history at one instant.
   subroutine put_envelopes(row, recorder, equation, t, y, y_dot)
      type(values_t), intent(inout) :: row
      type(envelope_recorder_t), intent(inout) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      !! [s]
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp), intent(in) :: y_dot(:)
      !! (states) their rates
      type(reactions_t) :: reactions

      if (.not. equation%has_wall) return
      if (.not. has_section_forces(equation)) return
      call find_forces(recorder, equation, t, y, y_dot)
      associate (base => recorder%above(:, 1)/equation%p%g, force => recorder%links%force, &
                 n => recorder%building%floors)
         call put(row, id%wall_shear_base_over_m_w_g, base(1))
         call put(row, id%wall_moment_base_over_m_w_g_m, base(2))
         if (n > 0) call put(row, id%link_i_force_over_m_w_g, sign(norm2(force, 1), force(1, :)) &
            /equation%p%g, n - size(force, 2))
      end associate
      if (.not. allocated(recorder%strip)) return
      reactions = reactions_at(equation, t, y, y_dot)
      call put_strip(row, recorder, reactions%normal, y(1))
   end subroutine put_envelopes

   !> Fill in the columns of the strip under the base.
   pure subroutine put_strip(row, recorder, normal, theta)
      type(values_t), intent(inout) :: row
      type(envelope_recorder_t), intent(in) :: recorder
      !! with a strip
      real(wp), intent(in) :: normal
      !! normal force of the pivot over m_w [m/s2]
      real(wp), intent(in) :: theta
      !! [rad]
      real(wp) :: strip(of_strip)

      strip = at_base(recorder, normal, theta)
      call put(row, id%contact_length_m, -strip(1))
      call put(row, id%toe_stress_Pa, min(strip(2), recorder%strip%strength))
      if (allocated(recorder%modulus)) call put(row, id%toe_strain, strip(2)/recorder%modulus)
   end subroutine put_strip

   !> Put the envelopes of the run.
   subroutine put_envelope_extremes(values, recorder, equation, theta, y)
      type(values_t), intent(inout) :: values
      type(envelope_recorder_t), intent(in) :: recorder
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: theta(2)
      !! smallest and largest rotation [rad]
      real(wp), intent(in) :: y(:)
      !! (states) at the end
      type(element_extremes_t) :: elements(size(recorder%watched))
      integer :: i

      call put_peaks(values, recorder)
      associate (last => size(recorder%largest) - 2*size(elements))
         do i = 1, size(elements)
            elements(i) = extremes_of(equation, recorder%watched(i), theta, y)
            elements(i)%travel = recorder%travel(i)
            elements(i)%force = [-1, 1]*recorder%largest([last + 2*i, last + 2*i - 1])/equation%p%g
         end do
      end associate
      call put_elements(values, elements)
   end subroutine put_envelope_extremes

end module rwmf_simulation_recorder_force_envelopes
